#pragma once

#include <algorithm>
#include <string>

#include <sensor_msgs/Image.h>

namespace recognition {

/// A tf frame's name as tf2 takes it: without the leading slashes of drivers and recordings from before tf2.
inline std::string plainFrame(const std::string& name) {
  return name.substr(std::min(name.size(), name.find_first_not_of('/')));
}

/// The message itself, or a copy whose frame is plain.
sensor_msgs::ImageConstPtr withPlainFrame(const sensor_msgs::ImageConstPtr& image);

}  // namespace recognition
