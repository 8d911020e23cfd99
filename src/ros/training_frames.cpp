#include "ros/training_frames.h"

#include <chrono>
#include <stdexcept>
#include <utility>

namespace recognition {
namespace {

constexpr double kTfPatience = 0.3;  // seconds that published tf may be later than the image

bool isLive(const messages::TrainObjectRequest& request) {
  return request.source == messages::TrainObjectRequest::LIVE;
}

}  // namespace

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

TfPoses::TfPoses(const messages::TrainObjectRequest& request)
    : tf_(isLive(request) ? ObjectTf::live(request.object_frame) : ObjectTf::ofBag(request.file, request.object_frame)),
      object_from_world_(Eigen::Translation3d(request.stands_at[0], request.stands_at[1], request.stands_at[2])),
      patience_(isLive(request) ? kTfPatience : 0.0) {}

Pose TfPoses::cameraFromWorld(const std_msgs::Header& image) const {
  const auto stamp = static_cast<std::int64_t>(image.stamp.toNSec());
  return tf_.cameraFromObject(image.frame_id, stamp, patience_) * object_from_world_;
}

BagViews::BagViews(const messages::TrainObjectRequest& request) : reader_(request.file) {
  if (!request.object_frame.empty()) poses_.emplace(request);
}

bool BagViews::next(RecordedView* view) {
  if (!reader_.next(&current_)) {
    if (reader_.skipped() == 0 || std::exchange(told_, true)) return false;
    throw std::runtime_error(std::to_string(reader_.skipped()) + " colour images have no depth or no camera info");
  }
  ++number_;
  *view = {current_.frame, std::nullopt, {}};
  if (poses_) view->camera_from_world = poses_->cameraFromWorld(header());
  return true;
}

std_msgs::Header BagViews::header() const {
  std_msgs::Header header;
  header.stamp.fromNSec(static_cast<std::uint64_t>(current_.stamp));
  header.frame_id = current_.frame_id;
  return header;
}

}  // namespace recognition
