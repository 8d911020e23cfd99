#pragma once

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"

namespace recognition::openni2 {

/// A typical Kinect's cameras at 640x480 (focal lengths as the community's drivers assume them, principal point in the
/// middle).
CameraModel typicalColorCamera();
CameraModel typicalInfraredCamera();

constexpr int kMaxDepth = 10000;        ///< millimetres; beyond it a Kinect's depth says nothing
constexpr uint16_t kNoRawDepth = 2047;  ///< the 11 bit value of an unseen pixel

/// Depth in millimetres of a Kinect's 11 bit value, 0 when it has none: triangulation with a typical Kinect's reference
/// plane, after Khoshelham and Elberink, Sensors 2012, eq. (6). For libraries that do not know the device's own
/// calibration.
int millimetresOfRaw(uint16_t raw);

/// The 11 bit value whose depth is nearest to this; kNoRawDepth for 0 and for what cannot be measured.
uint16_t rawOfMillimetres(int millimetres);

/// CV_16UC1 in millimetres of CV_16UC1 with 11 bit values.
cv::Mat millimetresOfRaw(const cv::Mat& raw);

}  // namespace recognition::openni2
