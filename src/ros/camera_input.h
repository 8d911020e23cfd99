#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <message_filters/sync_policies/approximate_time.h>
#include <image_transport/image_transport.h>
#include <message_filters/synchronizer.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include "ros/image_conversions.h"
#include "ros/repeat_filter.h"

namespace recognition {

/// Colour, depth and camera info of a camera, paired by their stamps within a bounded interval. Watches for topics that
/// stay silent. A message that is delivered twice counts once; frame names lose their leading slashes; a colour image
/// without a frame is a problem, as its results would have none.
///
/// Messages arrive and are paired in a thread of this class, where none is lost while a frame is worked on: a
/// subscriber's queue of one would replace them, and nobody would know how many. The newest frame waits until the
/// node's callback queue is free for it.
class CameraInput {
 public:
  using FrameCallback = std::function<void(const FrameMessages&)>;
  using ProblemCallback = std::function<void(const std::string& topics, const std::string& problem)>;
  using DropCallback = std::function<void()>;

  /// Private parameters: `max_interval` (0.02 s), the largest difference of stamps; `image_transport` and
  /// `depth_image_transport` (raw), by which images come. Throws std::invalid_argument naming a bad one. `frame` and
  /// `problem` are called in the node's callback queue; `dropped`, for each frame that a newer one replaces while it
  /// waits, in the thread of the arrivals.
  CameraInput(const ros::NodeHandle& parameters, const FrameCallback& frame, const ProblemCallback& problem,
              const DropCallback& dropped);
  ~CameraInput() { unsubscribe(); }

  /// Topics `rgb/image_rect_color`, `depth_registered/image_raw`, `rgb/camera_info` (remap them). Both are called in
  /// the node's callback queue. Of a colour topic that is not rectified (image_raw) distortion is undone, see
  /// rectified(): the images of such frames are copies.
  void subscribe(ros::NodeHandle& node);
  void unsubscribe();

  /// The topics as resolved, for messages.
  std::string topics() const;

  static const std::vector<std::string>& parameterNames();

  /// What arrived in the last seconds: topics, their rates, and how many were paired to frames. For diagnostics.
  using Report = std::vector<std::pair<std::string, std::string>>;
  Report report() const;

 private:
  using Policy =
      message_filters::sync_policies::ApproximateTime<sensor_msgs::Image, sensor_msgs::Image, sensor_msgs::CameraInfo>;
  using Synchronizer = message_filters::Synchronizer<Policy>;

  /// One of the three topics, by whichever transport.
  struct Input {
    std::string topic;
    std::function<std::uint32_t()> publishers;
    std::function<void()> shutdown;
  };

  template <int Index>
  Input subscribeToImage(ros::NodeHandle& node, const std::string& topic, const std::string& transport);
  Input subscribeToInfo(ros::NodeHandle& node, const std::string& topic);
  template <int Index, typename Message>
  void receive(const boost::shared_ptr<const Message>& message);
  /// False if it came already.
  template <int Index>
  bool arrived(const std_msgs::Header& header);
  void paired(const sensor_msgs::ImageConstPtr& color, const sensor_msgs::ImageConstPtr& depth,
              const sensor_msgs::CameraInfoConstPtr& info);
  void restart();
  void handOver();
  void watch();

  /// What came since the last look of watch().
  struct Arrivals {
    std::array<int, 3> messages{};
    std::array<ros::Time, 3> last;  // stamps
    int frames = 0;
  };

  const double max_interval_;
  const std::string color_transport_, depth_transport_;
  const FrameCallback frame_;
  const ProblemCallback problem_;
  const DropCallback dropped_;
  ros::CallbackQueueInterface* queue_ = nullptr;  // the node's
  ros::CallbackQueue arriving_;
  std::unique_ptr<ros::AsyncSpinner> thread_;   // of the arrivals
  std::unique_ptr<Synchronizer> synchronizer_;  // used in that thread only
  std::mutex mutex_;                            // guards the next two, of both threads
  Arrivals arrivals_;
  std::optional<FrameMessages> waiting_;
  std::array<RepeatFilter, 3> repeats_;  // used in the thread of the arrivals only
  std::array<Input, 3> inputs_;
  bool any_came_ = false;  // since the subscription
  ros::WallTime subscribed_;
  Report report_;
  ros::WallTimer timer_;
};

}  // namespace recognition
