#include "ros/camera_input.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include <boost/make_shared.hpp>

#include "ros/frame_names.h"
#include "ros/parameters.h"
#include "ros/queued_call.h"

namespace recognition {
namespace {

constexpr std::uint32_t kQueue = 10;  // messages of one topic: that arrive at once, or wait for partners
const ros::WallDuration kWatchInterval(3.0);
const ros::WallDuration kStartOfCamera(10.0);  // a driver may take as long until its first image
constexpr const char* kTransports[] = {"image_transport", "depth_image_transport"};

std::string perSecond(double rate) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f Hz", rate);
  return text;
}

std::string transportNamed(const ros::NodeHandle& parameters, const char* name) {
  const std::string transport = parameterOr(parameters, name, std::string("raw"));
  std::string there;
  for (const std::string& known : image_transport::ImageTransport(parameters).getLoadableTransports()) {
    const std::string plain = known.substr(known.rfind('/') + 1);
    if (plain == transport) return transport;
    there += " " + plain;
  }
  throw std::invalid_argument(parameters.resolveName(name) + " is '" + transport + "'; image_transport has:" + there);
}

}  // namespace

CameraInput::CameraInput(const ros::NodeHandle& parameters, const FrameCallback& frame, const ProblemCallback& problem,
                         const DropCallback& dropped)
    : max_interval_(numberInRange(parameters, "max_interval", 0.02, 0.0, 1.0)),
      color_transport_(transportNamed(parameters, kTransports[0])),
      depth_transport_(transportNamed(parameters, kTransports[1])),
      frame_(frame),
      problem_(problem),
      dropped_(dropped) {}

const std::vector<std::string>& CameraInput::parameterNames() {
  static const std::vector<std::string> names = {"max_interval", kTransports[0], kTransports[1]};
  return names;
}

void CameraInput::subscribe(ros::NodeHandle& node) {
  unsubscribe();
  restart();
  arrivals_ = {};
  queue_ = node.getCallbackQueue();
  ros::NodeHandle arriving(node);
  arriving.setCallbackQueue(&arriving_);
  any_came_ = false;
  subscribed_ = ros::WallTime::now();
  inputs_ = {subscribeToImage<0>(arriving, "rgb/image_rect_color", color_transport_),
             subscribeToImage<1>(arriving, "depth_registered/image_raw", depth_transport_),
             subscribeToInfo(arriving, "rgb/camera_info")};
  thread_ = std::make_unique<ros::AsyncSpinner>(1, &arriving_);
  thread_->start();
  timer_ = node.createWallTimer(kWatchInterval, [this](const ros::WallTimerEvent&) { watch(); });
}

void CameraInput::unsubscribe() {
  if (!thread_) return;
  timer_.stop();
  for (const Input& input : inputs_) input.shutdown();
  thread_.reset();  // waits for its end
  queue_->removeByID(reinterpret_cast<std::uint64_t>(this));
  waiting_.reset();
}

std::string CameraInput::topics() const { return inputs_[0].topic + ", " + inputs_[1].topic + ", " + inputs_[2].topic; }

template <int Index>
CameraInput::Input CameraInput::subscribeToImage(ros::NodeHandle& node, const std::string& topic,
                                                 const std::string& transport) {
  const auto subscriber = std::make_shared<image_transport::Subscriber>(image_transport::ImageTransport(node).subscribe(
      topic, kQueue, [this](const sensor_msgs::ImageConstPtr& image) { receive<Index>(image); }, ros::VoidPtr(),
      image_transport::TransportHints(transport)));
  return {node.resolveName(topic), [subscriber] { return subscriber->getNumPublishers(); },
          [subscriber] { subscriber->shutdown(); }};
}

CameraInput::Input CameraInput::subscribeToInfo(ros::NodeHandle& node, const std::string& topic) {
  const boost::function<void(const sensor_msgs::CameraInfoConstPtr&)> callback =
      [this](const sensor_msgs::CameraInfoConstPtr& info) { receive<2>(info); };
  const auto subscriber = std::make_shared<ros::Subscriber>(node.subscribe(topic, kQueue, callback));
  return {subscriber->getTopic(), [subscriber] { return subscriber->getNumPublishers(); },
          [subscriber] { subscriber->shutdown(); }};
}

template <int Index, typename Message>
void CameraInput::receive(const boost::shared_ptr<const Message>& message) {
  if (arrived<Index>(message->header)) synchronizer_->template add<Index>(ros::MessageEvent<const Message>(message));
}

template <int Index>
bool CameraInput::arrived(const std_msgs::Header& header) {
  if (repeats_[Index].isRepeat(header, ros::WallTime::now())) return false;
  const ros::Time& stamp = header.stamp;
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
  return true;
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
    waiting_ = {color, depth, info, ros::WallTime::now()};
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
  if (!frame) return;
  frame->color = withPlainFrame(frame->color);
  if (frame->color->header.frame_id.empty())
    return problem_(topics(), "colour image has no frame_id, so its results would have no frame: set it in the driver");
  try {
    *frame = rectified(*frame, inputs_[0].topic, inputs_[1].topic);
  } catch (const std::invalid_argument& error) {
    return problem_(topics(), error.what());
  }
  frame_(*frame);
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
  for (size_t i = 0; i < inputs_.size(); ++i)
    report_.push_back({kNames[i], inputs_[i].topic + " at " + perSecond(came.messages[i] / kWatchInterval.toSec())});
  report_.push_back({"paired", perSecond(came.frames / kWatchInterval.toSec())});
  const bool any = came.messages != std::array<int, 3>{};
  any_came_ = any_came_ || any;
  if (!any_came_ && ros::WallTime::now() - subscribed_ < kStartOfCamera) return;
  for (size_t i = 0; i < inputs_.size(); ++i) {
    if (came.messages[i] > 0) continue;
    const std::string& topic = inputs_[i].topic;
    if (inputs_[i].publishers() == 0)
      problem_(topic, "nobody publishes this topic");
    else if (any || !any_came_)
      problem_(topic, any ? "no message, while others of the camera arrive" : "no message yet");
  }
  if (came.frames == 0 && came.messages[0] > 0 && came.messages[1] > 0 && came.messages[2] > 0)
    problem_(topics(), "stamps differ by more than " + std::to_string(max_interval_) + " s: colour " +
                           std::to_string(came.last[0].toSec()) + ", depth " + std::to_string(came.last[1].toSec()) +
                           ", camera info " + std::to_string(came.last[2].toSec()));
}

}  // namespace recognition
