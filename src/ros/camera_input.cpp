#include "rgbd_recognition/ros/camera_input.h"

#include <algorithm>
#include <cstdio>

namespace rgbd_recognition {
namespace {

constexpr std::uint32_t kPairingQueue = 10;  // messages of one topic that wait for partners
const ros::WallDuration kWatchInterval(3.0);

std::string perSecond(double rate) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f Hz", rate);
  return text;
}

}  // namespace

CameraInput::CameraInput(double max_interval, const FrameCallback& frame, const ProblemCallback& problem)
    : max_interval_(max_interval), frame_(frame), problem_(problem) {}

void CameraInput::subscribe(ros::NodeHandle& node) {
  restart();
  subscribers_ = {subscribeTo<0, sensor_msgs::Image>(node, "rgb/image_rect_color"),
                  subscribeTo<1, sensor_msgs::Image>(node, "depth_registered/image_raw"),
                  subscribeTo<2, sensor_msgs::CameraInfo>(node, "rgb/camera_info")};
  arrived_ = {};
  frames_ = 0;
  timer_ = node.createWallTimer(kWatchInterval, [this](const ros::WallTimerEvent&) { watch(); });
}

void CameraInput::unsubscribe() {
  timer_.stop();
  for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
  synchronizer_.reset();
}

std::string CameraInput::topics() const {
  return subscribers_[0].getTopic() + ", " + subscribers_[1].getTopic() + ", " + subscribers_[2].getTopic();
}

template <int Index, typename Message>
ros::Subscriber CameraInput::subscribeTo(ros::NodeHandle& node, const std::string& topic) {
  const boost::function<void(const ros::MessageEvent<const Message>&)> arrived =
      [this](const ros::MessageEvent<const Message>& event) {
        const ros::Time stamp = event.getConstMessage()->header.stamp;
        if (stamp < last_[Index]) restart();  // a recording that begins again: nothing that waits will find a partner
        last_[Index] = stamp;
        ++arrived_[Index];
        synchronizer_->template add<Index>(event);
      };
  return node.subscribe<Message>(topic, 1, arrived);
}

void CameraInput::restart() {
  Policy policy(kPairingQueue);
  policy.setMaxIntervalDuration(ros::Duration(max_interval_));
  synchronizer_ = std::make_unique<Synchronizer>(policy);
  synchronizer_->registerCallback(&CameraInput::paired, this);
  last_ = {};
}

void CameraInput::paired(const sensor_msgs::ImageConstPtr& color, const sensor_msgs::ImageConstPtr& depth,
                         const sensor_msgs::CameraInfoConstPtr& info) {
  ++frames_;
  frame_({color, depth, info});
}

CameraInput::Report CameraInput::report() const { return report_; }

void CameraInput::watch() {
  static constexpr const char* kNames[] = {"colour", "depth", "camera info"};
  report_.clear();
  for (size_t i = 0; i < subscribers_.size(); ++i)
    report_.push_back({kNames[i], subscribers_[i].getTopic() + " at " +
                                      perSecond(arrived_[i] / kWatchInterval.toSec())});
  report_.push_back({"paired", perSecond(frames_ / kWatchInterval.toSec())});
  const int most = std::max({arrived_[0], arrived_[1], arrived_[2]});
  for (size_t i = 0; i < subscribers_.size(); ++i) {
    if (arrived_[i] > 0) continue;
    const std::string topic = subscribers_[i].getTopic();
    const bool published = subscribers_[i].getNumPublishers() > 0;
    if (!published)
      problem_(topic, "nobody publishes this topic");
    else if (most > 0)
      problem_(topic, "no message, while others of the camera arrive");
  }
  if (frames_ == 0 && arrived_[0] > 0 && arrived_[1] > 0 && arrived_[2] > 0)
    problem_(topics(), "stamps differ by more than " + std::to_string(max_interval_) + " s: colour " +
                           std::to_string(last_[0].toSec()) + ", depth " + std::to_string(last_[1].toSec()) +
                           ", camera info " + std::to_string(last_[2].toSec()));
  arrived_ = {};
  frames_ = 0;
}

}  // namespace rgbd_recognition
