#include "ros/target_frame.h"

#include <cstdio>
#include <stdexcept>

#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "rgbd_recognition/ros/message_conversions.h"

namespace recognition {
namespace {

std::string withoutSlash(const std::string& frame) { return frame.substr(frame.find_first_not_of('/')); }

}  // namespace

TargetFrame::TargetFrame(const std::string& name) {
  if (name.find_first_not_of('/') == std::string::npos) return;
  name_ = withoutSlash(name);
  buffer_ = std::make_unique<tf2_ros::Buffer>();
  listener_ = std::make_unique<tf2_ros::TransformListener>(*buffer_);
}

TargetFrame::~TargetFrame() = default;

Pose TargetFrame::targetFromCamera(const std_msgs::Header& header) const {
  if (isCamera(header)) return Pose::Identity();
  const std::string camera = header.frame_id;
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
