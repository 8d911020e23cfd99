#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <ros/node_handle.h>

#include "ros/image_conversions.h"
#include "ros/messages.h"
#include "ros/repeat_filter.h"

namespace recognition {

/// All messages of one frame on its way through the stages, with one stamp; only the depth image may keep one of its
/// own, which the segmentation tells, so that it need not be copied for it. Each stage hands on what it got and adds
/// its own, so that a later stage always has what belongs to the frame, however many frames another has dropped
/// meanwhile. In one manager this passes pointers.
struct FrameBundle {
  FrameMessages images;
  messages::SegmentationConstPtr segmentation;
  messages::SceneFeaturesConstPtr features;  ///< empty before that stage

  const std_msgs::Header& header() const { return images.color->header; }
};

/// Topics below a stage's name.
namespace bundle_topics {
constexpr const char* kColor = "color";
constexpr const char* kDepth = "depth";
constexpr const char* kCameraInfo = "camera_info";
constexpr const char* kSegmentation = "segmentation";
constexpr const char* kFeatures = "features";
}  // namespace bundle_topics

/// Publishes bundles below a stage's name.
class FrameBundleOutput {
 public:
  /// `advertise` makes a publisher of each topic (a nodelet's lazy ones).
  template <typename Advertiser>
  void advertise(const Advertiser& advertiser, bool with_features) {
    color_ = advertiser(sensor_msgs::Image(), bundle_topics::kColor);
    depth_ = advertiser(sensor_msgs::Image(), bundle_topics::kDepth);
    camera_info_ = advertiser(sensor_msgs::CameraInfo(), bundle_topics::kCameraInfo);
    segmentation_ = advertiser(messages::Segmentation(), bundle_topics::kSegmentation);
    if (with_features) features_ = advertiser(messages::SceneFeatures(), bundle_topics::kFeatures);
  }

  void publish(const FrameBundle& bundle) const;

 private:
  ros::Publisher color_, depth_, camera_info_, segmentation_, features_;
};

/// Gathers the messages of one stamp from the topics below a stage's name. A message delivered twice counts once.
class FrameBundleInput {
 public:
  using Callback = std::function<void(const FrameBundle&)>;

  void subscribe(ros::NodeHandle& node, const std::string& stage, bool with_features, const Callback& callback);
  void unsubscribe();

 private:
  template <typename Message, typename Place>
  void subscribeTo(ros::NodeHandle& node, const std::string& topic, const Place& place);
  void deliver(std::uint64_t stamp);
  void onDepth(const sensor_msgs::ImageConstPtr& depth);

  Callback callback_;
  bool with_features_ = false;
  std::map<std::uint64_t, FrameBundle> incomplete_;             // by stamp, nanoseconds
  std::map<std::uint64_t, sensor_msgs::ImageConstPtr> depths_;  // by their own stamps
  RepeatFilter depth_repeats_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace recognition
