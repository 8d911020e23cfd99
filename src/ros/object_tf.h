#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "rgbd_recognition/core/pose.h"

namespace tf2 {
class BufferCore;
}
namespace tf2_ros {
class TransformListener;
}

namespace recognition {

/// Where an object that tf knows is with respect to the camera.
class ObjectTf {
 public:
  /// All tf that a bag holds. Throws std::runtime_error that names the file and what is wrong: unreadable, no tf, or no
  /// such frame in it (with those that are).
  static ObjectTf ofBag(const std::string& file, const std::string& object_frame);
  /// tf as it is published, heard in a thread of its own. Throws std::invalid_argument for an empty name.
  static ObjectTf live(const std::string& object_frame);
  ObjectTf(ObjectTf&&) noexcept;
  ~ObjectTf();

  /// camera_from_object at an image's stamp (nanoseconds); waits for tf that is late by `patience` seconds at most.
  /// Throws std::runtime_error that names both frames, the stamp and what tf lacks; std::invalid_argument without a
  /// camera frame.
  Pose cameraFromObject(const std::string& camera_frame, std::int64_t stamp, double patience = 0.0) const;

 private:
  explicit ObjectTf(const std::string& object_frame);

  std::string object_;
  std::unique_ptr<tf2::BufferCore> buffer_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
};

}  // namespace recognition
