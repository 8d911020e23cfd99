#pragma once

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"

namespace recognition::openni2 {

/// Distance from a Kinect's infrared camera to its colour camera, metres, along the image rows (kinect_frames.launch
/// of rgbd_launch).
constexpr double kColorCameraRightOfInfrared = 0.025;

/// What a second camera sees of a depth image (CV_16UC1, millimetres, 0 unknown): each pixel goes where its point
/// lies once that has been moved by `shift_x` metres along x; the nearest wins. Pixels that nothing falls on stay 0.
cv::Mat warpDepth(const cv::Mat& depth_mm, const CameraModel& from, const CameraModel& to, double shift_x);

}  // namespace recognition::openni2
