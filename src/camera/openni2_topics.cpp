#include "camera/openni2_topics.h"

#include <cctype>
#include <cstdlib>
#include <filesystem>

#include "camera/openni2_camera_info.h"
#include "ros/frame_names.h"
#include "ros/parameters.h"

namespace recognition {
namespace {

constexpr int kQueue = 1;
constexpr double kProjectorBaseline = 0.075;  // m, from a Kinect's infrared camera

using Manager = camera_info_manager::CameraInfoManager;

/// Camera names may hold letters, digits and underscores only.
std::string calibrationName(const std::string& prefix, const std::string& serial) {
  std::string name = prefix + "_" + (serial.empty() ? "unknown" : serial);
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return name;
}

void loadCalibration(Manager& manager, const std::string& name, const std::string& url) {
  manager.setCameraName(name);
  manager.loadCameraInfo(url);
}

/// Whether set_camera_info stored one.
bool isStored(const std::string& name) {
  const char *ros_home = std::getenv("ROS_HOME"), *home = std::getenv("HOME");
  const std::string folder = ros_home ? ros_home : std::string(home ? home : "") + "/.ros";
  std::error_code error;
  return std::filesystem::exists(folder + "/camera_info/" + name + ".yaml", error);
}

/// An ideal camera needs none. Without this the manager would look for one, and warn that there is none.
void expectNoCalibration(Manager& manager, const std::string& name) {
  manager.setCameraName(name);
  manager.setCameraInfo(sensor_msgs::CameraInfo());
}

}  // namespace

OpenNi2Topics::OpenNi2Topics(ros::NodeHandle& node, ros::NodeHandle& parameters, std::function<void()> changed) {
  const std::string camera = plainFrame(parameterOr<std::string>(parameters, "camera_name", "camera"));
  rgb_frame_ = plainFrame(parameterOr(parameters, "rgb_frame_id", camera + "_rgb_optical_frame"));
  depth_frame_ = plainFrame(parameterOr(parameters, "depth_frame_id", camera + "_depth_optical_frame"));
  rgb_url_ = parameterOr<std::string>(parameters, "rgb_camera_info_url", "");
  depth_url_ = parameterOr<std::string>(parameters, "depth_camera_info_url", "");
  rgb_calibration_ = std::make_unique<Manager>(ros::NodeHandle(node, "rgb"), "rgb");
  depth_calibration_ = std::make_unique<Manager>(ros::NodeHandle(node, "ir"), "depth");

  image_transport::ImageTransport transport(node);
  const auto image_changed = [changed](const image_transport::SingleSubscriberPublisher&) { changed(); };
  const auto info_changed = [changed](const ros::SingleSubscriberPublisher&) { changed(); };
  const auto advertise = [&](const char* topic) {
    return transport.advertiseCamera(topic, kQueue, image_changed, image_changed, info_changed, info_changed);
  };
  rgb_ = advertise("rgb/image_raw");
  depth_ = advertise("depth/image_raw");
  registered_ = advertise("depth_registered/image_raw");
  ir_ = advertise("ir/image");
  projector_ = node.advertise<sensor_msgs::CameraInfo>("projector/camera_info", kQueue, info_changed, info_changed);
}

bool OpenNi2Topics::wanted(Sensor sensor) const {
  switch (sensor) {
    case Sensor::kColor:
      return rgb_.getNumSubscribers() > 0;
    case Sensor::kInfrared:
      return ir_.getNumSubscribers() > 0;
    default:
      return depth_.getNumSubscribers() + registered_.getNumSubscribers() + projector_.getNumSubscribers() > 0;
  }
}

bool OpenNi2Topics::misses(bool registered) const {
  return (registered ? depth_ : registered_).getNumSubscribers() > 0;
}

void OpenNi2Topics::deviceOpened(const std::string& serial, bool is_ideal,
                                 const std::array<sensor_msgs::CameraInfo, kSensors>& ideal_cameras) {
  const auto load = [&](Manager& manager, const std::string& prefix, const std::string& url) {
    const std::string name = calibrationName(prefix, serial);
    const bool needs_none = is_ideal && url.empty() && !isStored(name);
    needs_none ? expectNoCalibration(manager, name) : loadCalibration(manager, name, url);
  };
  load(*rgb_calibration_, "rgb", rgb_url_);
  load(*depth_calibration_, "depth", depth_url_);
  const std::lock_guard<std::mutex> lock(mutex_);
  ideal_cameras_ = ideal_cameras;
}

sensor_msgs::CameraInfoPtr OpenNi2Topics::cameraInfo(Sensor sensor, const sensor_msgs::Image& image) {
  const int width = static_cast<int>(image.width);
  const int height = static_cast<int>(image.height);
  Manager& calibration = sensor == Sensor::kColor ? *rgb_calibration_ : *depth_calibration_;
  auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  if (calibration.isCalibrated()) {
    *info = scaledCameraInfo(calibration.getCameraInfo(), width, height);
  } else {
    const std::lock_guard<std::mutex> lock(mutex_);
    *info = scaledCameraInfo(ideal_cameras_[static_cast<size_t>(sensor)], width, height);
  }
  info->header = image.header;
  return info;
}

void OpenNi2Topics::publish(Sensor sensor, const sensor_msgs::ImagePtr& image, const ros::Time& stamp,
                            bool registered) {
  const bool colors_view = sensor == Sensor::kColor || (sensor == Sensor::kDepth && registered);
  image->header.stamp = stamp;
  image->header.frame_id = colors_view ? rgb_frame_ : depth_frame_;
  const sensor_msgs::CameraInfoPtr info = cameraInfo(colors_view ? Sensor::kColor : sensor, *image);
  switch (sensor) {
    case Sensor::kColor:
      rgb_.publish(image, info);
      break;
    case Sensor::kInfrared:
      ir_.publish(image, info);
      break;
    default:
      (registered ? registered_ : depth_).publish(image, info);
  }
  if (sensor == Sensor::kDepth && projector_.getNumSubscribers() > 0) {
    projector_.publish(boost::make_shared<sensor_msgs::CameraInfo>(projectorInfo(*info, kProjectorBaseline)));
  }
}

}  // namespace recognition
