#include "ros/frame_bundle.h"

#include <iterator>

namespace recognition {
namespace {

constexpr size_t kMaxIncomplete = 4;  // frames whose messages overlap in time

std::uint64_t depthStamp(const messages::Segmentation& segmentation) {
  const ros::Time& own = segmentation.depth_stamp;
  return (own.isZero() ? segmentation.header.stamp : own).toNSec();
}

}  // namespace

void FrameBundleOutput::publish(const FrameBundle& bundle) const {
  color_.publish(bundle.images.color);
  depth_.publish(bundle.images.depth);
  camera_info_.publish(bundle.images.camera_info);
  segmentation_.publish(bundle.segmentation);
  if (bundle.features) features_.publish(bundle.features);
}

template <typename Message, typename Place>
void FrameBundleInput::subscribeTo(ros::NodeHandle& node, const std::string& topic, const Place& place) {
  const boost::function<void(const boost::shared_ptr<const Message>&)> arrived =
      [this, place, repeats = RepeatFilter()](const boost::shared_ptr<const Message>& message) mutable {
        if (repeats.isRepeat(message->header, ros::WallTime::now())) return;
        const std::uint64_t stamp = message->header.stamp.toNSec();
        place(incomplete_[stamp]) = message;
        deliver(stamp);
      };
  subscribers_.push_back(node.subscribe<Message>(topic, 1, arrived));
}

void FrameBundleInput::subscribe(ros::NodeHandle& node, const std::string& stage, bool with_features,
                                 const Callback& callback) {
  callback_ = callback;
  with_features_ = with_features;
  const std::string prefix = stage + "/";
  subscribeTo<sensor_msgs::Image>(
      node, prefix + bundle_topics::kColor, [](FrameBundle & b) -> auto& { return b.images.color; });
  subscribers_.push_back(node.subscribe(prefix + bundle_topics::kDepth, 1, &FrameBundleInput::onDepth, this));
  subscribeTo<sensor_msgs::CameraInfo>(
      node, prefix + bundle_topics::kCameraInfo, [](FrameBundle & b) -> auto& { return b.images.camera_info; });
  subscribeTo<messages::Segmentation>(
      node, prefix + bundle_topics::kSegmentation, [](FrameBundle & b) -> auto& { return b.segmentation; });
  if (with_features)
    subscribeTo<messages::SceneFeatures>(
        node, prefix + bundle_topics::kFeatures, [](FrameBundle & b) -> auto& { return b.features; });
}

void FrameBundleInput::unsubscribe() {
  subscribers_.clear();
  incomplete_.clear();
  depths_.clear();
  depth_repeats_ = {};
}

void FrameBundleInput::onDepth(const sensor_msgs::ImageConstPtr& depth) {
  if (depth_repeats_.isRepeat(depth->header, ros::WallTime::now())) return;
  const std::uint64_t own = depth->header.stamp.toNSec();
  depths_[own] = depth;
  while (depths_.size() > kMaxIncomplete)
    depths_.erase(depths_.begin()->first != own ? depths_.begin() : std::prev(depths_.end()));
  for (const auto& [stamp, bundle] : incomplete_)
    if (bundle.segmentation && depthStamp(*bundle.segmentation) == own) return deliver(stamp);
}

void FrameBundleInput::deliver(std::uint64_t stamp) {
  FrameBundle& bundle_so_far = incomplete_[stamp];
  if (bundle_so_far.segmentation)
    if (const auto depth = depths_.find(depthStamp(*bundle_so_far.segmentation)); depth != depths_.end())
      bundle_so_far.images.depth = depth->second;
  const FrameBundle bundle = bundle_so_far;
  const bool complete = bundle.images.color && bundle.images.depth && bundle.images.camera_info &&
                        bundle.segmentation && (bundle.features || !with_features_);
  if (!complete) {
    while (incomplete_.size() > kMaxIncomplete)
      incomplete_.erase(incomplete_.begin()->first != stamp ? incomplete_.begin() : std::prev(incomplete_.end()));
    return;
  }
  incomplete_.erase(incomplete_.begin(), incomplete_.upper_bound(stamp));  // older ones cannot become complete any more
  depths_.erase(depths_.begin(), depths_.upper_bound(bundle.images.depth->header.stamp.toNSec()));
  callback_(bundle);
}

}  // namespace recognition
