#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>

#include "rgbd_recognition/ros/image_conversions.h"

namespace rgbd_recognition {

/// Hands a camera's frames from the thread that receives them to one that works on them; while that works, newer frames
/// take the place of older ones.
class LatestFrame {
 public:
  /// From now on frames are taken; what waited is gone.
  void open();
  /// Ends a take() that waits.
  void close();
  bool isOpen() const;

  void offer(const FrameMessages& frame);
  /// Waits for a frame; nothing after `seconds` without one, or if closed.
  std::optional<FrameMessages> take(double seconds);

 private:
  mutable std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  std::optional<FrameMessages> frame_;
  bool open_ = false;
};

}  // namespace rgbd_recognition
