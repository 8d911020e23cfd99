#include "openni2/camera_bench.h"

#include <dynamic_reconfigure/Reconfigure.h>

#include <cmath>

namespace recognition::openni2 {
namespace {

dynamic_reconfigure::Config call(const std::string& service, const dynamic_reconfigure::Config& config) {
  dynamic_reconfigure::Reconfigure reconfigure;
  reconfigure.request.config = config;
  ros::service::call(service, reconfigure);
  return reconfigure.response.config;
}

}  // namespace

Camera::Camera(const std::string& name, const std::map<std::string, XmlRpc::XmlRpcValue>& parameters)
    : name_(name), diagnostics_("/diagnostics"), loader_(false) {
  const std::string node = "/" + name + "/driver";
  ros::param::del(node);
  ros::param::set(node + "/diagnostic_period", 0.2);
  ros::param::set(node + "/retry_period", 0.2);
  for (const auto& [parameter, value] : parameters) ros::param::set(node + "/" + parameter, value);
  loaded_ = loader_.load(node, "rgbd_recognition/openni2_camera", ros::M_string(), nodelet::V_string());
}

Camera::~Camera() { loader_.clear(); }

std::string Camera::reconfigure(const std::string& parameter, const char* value) {
  dynamic_reconfigure::Config config;
  config.strs.resize(1);
  config.strs[0].name = parameter;
  config.strs[0].value = value;
  for (const auto& taken : call(topic("driver/set_parameters"), config).strs) {
    if (taken.name == parameter) return taken.value;
  }
  return "";
}

bool Camera::reconfigure(const std::string& parameter, bool value) {
  dynamic_reconfigure::Config config;
  config.bools.resize(1);
  config.bools[0].name = parameter;
  config.bools[0].value = value;
  for (const auto& taken : call(topic("driver/set_parameters"), config).bools) {
    if (taken.name == parameter) return taken.value;
  }
  return !value;
}

double Camera::reconfigure(const std::string& parameter, double value) {
  dynamic_reconfigure::Config config;
  config.doubles.resize(1);
  config.doubles[0].name = parameter;
  config.doubles[0].value = value;
  for (const auto& taken : call(topic("driver/set_parameters"), config).doubles) {
    if (taken.name == parameter) return taken.value;
  }
  return std::nan("");
}

bool Camera::reports(const std::function<bool(int, const std::string&, const Values&)>& wanted) {
  return diagnostics_.next([&](const diagnostic_msgs::DiagnosticArray& array) {
    for (const diagnostic_msgs::DiagnosticStatus& status : array.status) {
      if (status.name.find(name_ + "/driver") == std::string::npos) continue;
      Values values;
      for (const diagnostic_msgs::KeyValue& value : status.values) values[value.key] = value.value;
      if (wanted(status.level, status.message, values)) return true;
    }
    return false;
  }) != nullptr;
}

}  // namespace recognition::openni2
