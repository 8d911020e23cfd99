#include "ros/camera_input.h"

#include <cstdio>

#include <boost/make_shared.hpp>

namespace recognition {
namespace {

constexpr std::uint32_t kQueue = 10;  // messages of one topic: that arrive at once, or wait for partners
const ros::WallDuration kWatchInterval(3.0);

/// A function in a callback queue.
class QueuedCall : public ros::CallbackInterface {
 public:
  explicit QueuedCall(const std::function<void()>& function) : function_(function) {}
  CallResult call() override {
    function_();
    return Success;
  }

 private:
  const std::function<void()> function_;
};

std::string perSecond(double rate) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f Hz", rate);
  return text;
}

}  // namespace

CameraInput::CameraInput(double max_interval, const FrameCallback& frame, const ProblemCallback& problem,
                         const DropCallback& dropped)
    : max_interval_(max_interval), frame_(frame), problem_(problem), dropped_(dropped) {}

void CameraInput::subscribe(ros::NodeHandle& node) {
  unsubscribe();
  restart();
  arrivals_ = {};
  queue_ = node.getCallbackQueue();
  ros::NodeHandle arriving(node);
  arriving.setCallbackQueue(&arriving_);
  subscribers_ = {subscribeTo<0, sensor_msgs::Image>(arriving, "rgb/image_rect_color"),
                  subscribeTo<1, sensor_msgs::Image>(arriving, "depth_registered/image_raw"),
                  subscribeTo<2, sensor_msgs::CameraInfo>(arriving, "rgb/camera_info")};
  thread_ = std::make_unique<ros::AsyncSpinner>(1, &arriving_);
  thread_->start();
  timer_ = node.createWallTimer(kWatchInterval, [this](const ros::WallTimerEvent&) { watch(); });
}

void CameraInput::unsubscribe() {
  if (!thread_) return;
  timer_.stop();
  for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
  thread_.reset();  // waits for its end
  queue_->removeByID(reinterpret_cast<std::uint64_t>(this));
  waiting_.reset();
}

std::string CameraInput::topics() const {
  return subscribers_[0].getTopic() + ", " + subscribers_[1].getTopic() + ", " + subscribers_[2].getTopic();
}

template <int Index, typename Message>
ros::Subscriber CameraInput::subscribeTo(ros::NodeHandle& node, const std::string& topic) {
  const boost::function<void(const ros::MessageEvent<const Message>&)> callback =
      [this](const ros::MessageEvent<const Message>& event) {
        arrived<Index>(event.getConstMessage()->header.stamp);
        synchronizer_->template add<Index>(event);
      };
  return node.subscribe<Message>(topic, kQueue, callback);
}

template <int Index>
void CameraInput::arrived(const ros::Time& stamp) {
  bool begins_again = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    begins_again = stamp < arrivals_.last[Index];
    if (begins_again) arrivals_.last = {};
    arrivals_.last[Index] = stamp;
    ++arrivals_.messages[Index];
  }
  // What waits of a recording that begins again has no partner. Not under the lock: a synchronizer has one of its own,
  // under which it calls paired(), which takes ours.
  if (begins_again) restart();
}

void CameraInput::restart() {
  Policy policy(kQueue);
  policy.setMaxIntervalDuration(ros::Duration(max_interval_));
  synchronizer_ = std::make_unique<Synchronizer>(policy);
  synchronizer_->registerCallback(&CameraInput::paired, this);
}

void CameraInput::paired(const sensor_msgs::ImageConstPtr& color, const sensor_msgs::ImageConstPtr& depth,
                         const sensor_msgs::CameraInfoConstPtr& info) {
  bool replaces = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++arrivals_.frames;
    replaces = waiting_.has_value();
    waiting_ = {color, depth, info};
  }
  if (replaces) return dropped_();
  queue_->addCallback(boost::make_shared<QueuedCall>([this] { handOver(); }), reinterpret_cast<std::uint64_t>(this));
}

void CameraInput::handOver() {
  std::optional<FrameMessages> frame;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    frame.swap(waiting_);
  }
  if (frame) frame_(*frame);
}

CameraInput::Report CameraInput::report() const { return report_; }

void CameraInput::watch() {
  static constexpr const char* kNames[] = {"colour", "depth", "camera info"};
  Arrivals came;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    came = arrivals_;
    arrivals_.messages = {};
    arrivals_.frames = 0;
  }
  report_.clear();
  for (size_t i = 0; i < subscribers_.size(); ++i)
    report_.push_back({kNames[i], subscribers_[i].getTopic() + " at " +
                                      perSecond(came.messages[i] / kWatchInterval.toSec())});
  report_.push_back({"paired", perSecond(came.frames / kWatchInterval.toSec())});
  const bool any = came.messages != std::array<int, 3>{};
  for (size_t i = 0; i < subscribers_.size(); ++i) {
    if (came.messages[i] > 0) continue;
    const std::string topic = subscribers_[i].getTopic();
    const bool published = subscribers_[i].getNumPublishers() > 0;
    if (!published)
      problem_(topic, "nobody publishes this topic");
    else if (any)
      problem_(topic, "no message, while others of the camera arrive");
  }
  if (came.frames == 0 && came.messages[0] > 0 && came.messages[1] > 0 && came.messages[2] > 0)
    problem_(topics(), "stamps differ by more than " + std::to_string(max_interval_) + " s: colour " +
                           std::to_string(came.last[0].toSec()) + ", depth " + std::to_string(came.last[1].toSec()) +
                           ", camera info " + std::to_string(came.last[2].toSec()));
}

}  // namespace recognition
