#pragma once

#include <opencv2/core.hpp>
#include <ros/time.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>

#include "rgbd_recognition/core/distortion.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {

/// The messages that make up one RGB-D frame, kept alive while a view of their pixels is in use.
struct FrameMessages {
  sensor_msgs::ImageConstPtr color;
  sensor_msgs::ImageConstPtr depth;
  sensor_msgs::CameraInfoConstPtr camera_info;
  ros::WallTime arrived{};  ///< when they were paired; zero: not from a camera
};

/// A view of the messages' pixels: nothing is copied. Throws std::invalid_argument that names the message (colour,
/// depth, camera info), the value and what is allowed: encodings, byte order, step, sizes, calibration, frames (depth
/// must be registered to colour; leading slashes do not count).
RgbdFrame frameView(const FrameMessages& messages);

/// The same for colour that is not rectified (image_raw): a frame of its own whose distortion (D) is undone, with the
/// camera P. Throws as frameView() does, and for an unknown distortion model.
RgbdFrame undistortedFrame(const FrameMessages& messages, bool depth_is_rectified = false);

/// Whether a topic's images are rectified, by its name (image_proc's: image_rect, image_rect_color).
bool isRectified(const std::string& topic);

/// The messages themselves, or, where colour comes by a topic that is not rectified and its camera info tells of a
/// distortion, those of undistortedFrame(), with copies of the images. Throws as that does.
FrameMessages rectified(const FrameMessages& messages, const std::string& color_topic, const std::string& depth_topic);

/// The distortion that a camera info tells of, of the image before rectification.
Distortion distortionOf(const sensor_msgs::CameraInfo& info);

/// Views of one image: 8-bit colour (rgb8, bgr8, 8UC3 as bgr8), depth (16UC1, mono16, 32FC1), or any one-channel type
/// of ours (mono8, 32SC1).
cv::Mat colorView(const sensor_msgs::Image& image, ColorOrder* order);
cv::Mat depthView(const sensor_msgs::Image& image);
cv::Mat labelView(const sensor_msgs::Image& image);
cv::Mat maskView(const sensor_msgs::Image& image);

/// The rectified camera (REP 104: P, with binning and region of interest), and that of the image before (K).
CameraModel cameraFromInfo(const sensor_msgs::CameraInfo& info);
CameraModel rawCameraFromInfo(const sensor_msgs::CameraInfo& info);

/// A colour image as the core reads it: the message itself, or a converted copy of rgba8, bgra8, mono8, those in 16
/// bits, the Bayer patterns, and yuv422. Another encoding passes as it is, for frameView() to refuse.
sensor_msgs::ImageConstPtr colorWithThreeChannels(const sensor_msgs::ImageConstPtr& image);

/// Depth image (32FC1 metres, NaN invalid) of an organised cloud, with its stamp and frame. Throws
/// std::invalid_argument for an unorganised cloud, one without a float field z, or one whose sizes do not fit its data.
sensor_msgs::ImagePtr depthFromPoints(const sensor_msgs::PointCloud2& cloud);

/// Camera info of a rectified image without distortion.
sensor_msgs::CameraInfo cameraInfo(const CameraModel& camera, const std_msgs::Header& header);

/// A message with a copy of a matrix: mono8, bgr8, 16UC1, 32SC1 or 32FC1 by its type.
sensor_msgs::ImagePtr imageMessage(const cv::Mat& pixels, const std_msgs::Header& header);
void fillImage(const cv::Mat& pixels, const std_msgs::Header& header, sensor_msgs::Image* image);

}  // namespace recognition
