#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <nodelet/loader.h>

#include <functional>
#include <map>
#include <string>

#include "openni2/listener.h"

namespace recognition::openni2 {

/// A camera nodelet in a namespace of its own, in this process.
class Camera {
 public:
  /// `parameters` are the nodelet's private ones.
  Camera(const std::string& name, const std::map<std::string, XmlRpc::XmlRpcValue>& parameters);
  ~Camera();

  bool loaded() const { return loaded_; }
  std::string topic(const std::string& relative) const { return "/" + name_ + "/" + relative; }

  /// Sets one parameter by dynamic reconfigure; returns the value that the nodelet took.
  std::string reconfigure(const std::string& parameter, const char* value);
  bool reconfigure(const std::string& parameter, bool value);
  double reconfigure(const std::string& parameter, double value);

  /// Waits until the camera's diagnostics satisfy `wanted`, given the level, the message, and all values by name.
  using Values = std::map<std::string, std::string>;
  bool reports(const std::function<bool(int level, const std::string& message, const Values& values)>& wanted);

 private:
  const std::string name_;
  Listener<diagnostic_msgs::DiagnosticArray> diagnostics_;
  nodelet::Loader loader_;
  bool loaded_ = false;
};

}  // namespace recognition::openni2
