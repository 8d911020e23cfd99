#pragma once

#include <memory>
#include <string>

#include <std_msgs/Header.h>

#include "rgbd_recognition/core/pose.h"

namespace tf2_ros {
class Buffer;
class TransformListener;
}  // namespace tf2_ros

namespace recognition {

/// The frame in which results are wanted, and where the camera is in it, through tf.
class TargetFrame {
 public:
  /// Listens to tf in a thread of its own. With an empty name results stay in the camera's frame.
  explicit TargetFrame(const std::string& name);
  ~TargetFrame();

  /// The frame of results for an image with this header.
  std::string nameFor(const std_msgs::Header& header) const;
  /// True if results stay in the frame of that image.
  bool isCamera(const std_msgs::Header& header) const;

  /// At the header's stamp, without waiting. Throws std::runtime_error that says whether tf is missing or stale, by how
  /// much, and what to look at.
  Pose targetFromCamera(const std_msgs::Header& header) const;

 private:
  [[noreturn]] void tell(const std_msgs::Header& header, const std::string& reason) const;

  std::string name_;
  std::unique_ptr<tf2_ros::Buffer> buffer_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
};

}  // namespace recognition
