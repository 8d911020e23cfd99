#include "ros/frame_names.h"

#include <boost/make_shared.hpp>

namespace recognition {

sensor_msgs::ImageConstPtr withPlainFrame(const sensor_msgs::ImageConstPtr& image) {
  const std::string& frame = image->header.frame_id;
  if (frame.empty() || frame.front() != '/') return image;
  const auto copy = boost::make_shared<sensor_msgs::Image>(*image);
  copy->header.frame_id = plainFrame(frame);
  return copy;
}

}  // namespace recognition
