#pragma once

#include <camera_info_manager/camera_info_manager.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "camera/openni2_device.h"

namespace recognition {

/// The topics, frames and calibrations of an OpenNI2 camera, named as the community's drivers name them:
/// rgb/image_raw, depth/image_raw (16UC1 mm), depth_registered/image_raw (as the colour camera sees it), ir/image, each
/// with its camera_info, and projector/camera_info.
class OpenNi2Topics {
 public:
  /// `changed` is called, on any thread, when listeners come or go. Private parameters: camera_name (frames' prefix),
  /// rgb_frame_id, depth_frame_id, rgb_camera_info_url, depth_camera_info_url.
  OpenNi2Topics(ros::NodeHandle& node, ros::NodeHandle& parameters, std::function<void()> changed);

  /// Whether anyone listens to what the sensor gives.
  bool wanted(Sensor sensor) const;
  /// A listener waits at depth/image_raw while depth goes to depth_registered (or the other way round).
  bool misses(bool registered) const;

  /// Loads the calibrations of this device; without them its ideal cameras serve. `is_ideal`: they are exact, as of a
  /// virtual device, and nobody is warned that there is none.
  void deviceOpened(const std::string& serial, bool is_ideal,
                    const std::array<sensor_msgs::CameraInfo, kSensors>& ideal_cameras);

  /// Sends a frame by pointer, with its camera info. Fills in the image's header.
  void publish(Sensor sensor, const sensor_msgs::ImagePtr& image, const ros::Time& stamp, bool registered);

 private:
  sensor_msgs::CameraInfoPtr cameraInfo(Sensor sensor, const sensor_msgs::Image& image);

  std::string rgb_frame_;
  std::string depth_frame_;
  std::string rgb_url_;
  std::string depth_url_;
  image_transport::CameraPublisher rgb_;
  image_transport::CameraPublisher depth_;
  image_transport::CameraPublisher registered_;
  image_transport::CameraPublisher ir_;
  ros::Publisher projector_;

  std::mutex mutex_;  ///< protects the ideal cameras
  std::array<sensor_msgs::CameraInfo, kSensors> ideal_cameras_;
  std::unique_ptr<camera_info_manager::CameraInfoManager> rgb_calibration_;
  std::unique_ptr<camera_info_manager::CameraInfoManager> depth_calibration_;
};

}  // namespace recognition
