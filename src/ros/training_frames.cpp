#include "rgbd_recognition/ros/training_frames.h"

#include <chrono>
#include <utility>

namespace rgbd_recognition {

void LatestFrame::open() {
  const std::lock_guard<std::mutex> lock(mutex_);
  open_ = true;
  frame_.reset();
}

void LatestFrame::close() {
  const std::lock_guard<std::mutex> lock(mutex_);
  open_ = false;
  frame_.reset();
  changed_.notify_all();
}

bool LatestFrame::isOpen() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return open_;
}

void LatestFrame::offer(const FrameMessages& frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!open_) return;
  frame_ = frame;
  changed_.notify_all();
}

std::optional<FrameMessages> LatestFrame::take(double seconds) {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return frame_ || !open_; });
  return std::exchange(frame_, std::nullopt);
}

}  // namespace rgbd_recognition
