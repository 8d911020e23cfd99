#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/synchronizer.h>
#include <ros/node_handle.h>

#include "rgbd_recognition/ros/image_conversions.h"

namespace rgbd_recognition {

/// Colour, depth and camera info of a camera, paired by their stamps within a bounded interval. Watches for topics that
/// stay silent.
class CameraInput {
 public:
  using FrameCallback = std::function<void(const FrameMessages&)>;
  using ProblemCallback = std::function<void(const std::string& topics, const std::string& problem)>;

  /// `max_interval`: largest difference of stamps, seconds.
  CameraInput(double max_interval, const FrameCallback& frame, const ProblemCallback& problem);

  /// Topics `rgb/image_rect_color`, `depth_registered/image_raw`, `rgb/camera_info` (remap them).
  void subscribe(ros::NodeHandle& node);
  void unsubscribe();

  /// The topics as resolved, for messages.
  std::string topics() const;

  /// What arrived in the last seconds: topics, their rates, and how many were paired to frames. For diagnostics.
  using Report = std::vector<std::pair<std::string, std::string>>;
  Report report() const;

 private:
  using Policy =
      message_filters::sync_policies::ApproximateTime<sensor_msgs::Image, sensor_msgs::Image, sensor_msgs::CameraInfo>;
  using Synchronizer = message_filters::Synchronizer<Policy>;

  template <int Index, typename Message>
  ros::Subscriber subscribeTo(ros::NodeHandle& node, const std::string& topic);
  void paired(const sensor_msgs::ImageConstPtr& color, const sensor_msgs::ImageConstPtr& depth,
              const sensor_msgs::CameraInfoConstPtr& info);
  void restart();
  void watch();

  double max_interval_;
  FrameCallback frame_;
  ProblemCallback problem_;
  std::unique_ptr<Synchronizer> synchronizer_;
  std::array<ros::Subscriber, 3> subscribers_;
  std::array<int, 3> arrived_{};  // since the last look of watch()
  std::array<ros::Time, 3> last_;
  int frames_ = 0;  // since the last look of watch()
  Report report_;
  ros::WallTimer timer_;
};

}  // namespace rgbd_recognition
