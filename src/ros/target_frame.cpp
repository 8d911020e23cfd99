#include "ros/target_frame.h"

#include <cstdio>
#include <stdexcept>

#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "ros/message_conversions.h"
#include "ros/frame_names.h"

namespace recognition {

TargetFrame::TargetFrame(const std::string& name) : name_(plainFrame(name)) {
  if (name_.empty()) return;
  buffer_ = std::make_unique<tf2_ros::Buffer>();
  listener_ = std::make_unique<tf2_ros::TransformListener>(*buffer_);
}

TargetFrame::~TargetFrame() = default;

std::string TargetFrame::nameFor(const std_msgs::Header& header) const {
  return name_.empty() ? plainFrame(header.frame_id) : name_;
}

bool TargetFrame::isCamera(const std_msgs::Header& header) const {
  return nameFor(header) == plainFrame(header.frame_id);
}

Pose TargetFrame::targetFromCamera(const std_msgs::Header& header) const {
  if (isCamera(header)) return Pose::Identity();
  const std::string camera = plainFrame(header.frame_id);
  try {
    return poseFromMessage(buffer_->lookupTransform(name_, camera, header.stamp).transform);
  } catch (const tf2::ExtrapolationException&) {
    const ros::Time newest = buffer_->lookupTransform(name_, camera, ros::Time(0)).header.stamp;
    const double age = (header.stamp - newest).toSec();
    char text[200];
    std::snprintf(text, sizeof(text),
                  age > 0.0 ? "tf is stale: its newest transform is %.3f s older than the image; does its publisher "
                              "run, do the machines' clocks agree?"
                            : "tf does not go back to the image's stamp: it is %.3f s newer; do the machines' clocks "
                              "agree?",
                  std::abs(age));
    tell(header, text);
  } catch (const tf2::TransformException& error) {
    tell(header, "tf does not connect them: " + std::string(error.what()));
  }
}

void TargetFrame::tell(const std_msgs::Header& header, const std::string& reason) const {
  throw std::runtime_error("no result in target_frame '" + name_ + "' for an image in frame '" + header.frame_id +
                           "': " + reason);
}

}  // namespace recognition
