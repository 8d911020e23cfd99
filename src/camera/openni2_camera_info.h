#pragma once

#include <sensor_msgs/CameraInfo.h>

#include "camera/openni2_intrinsics.h"

namespace recognition {

/// CameraInfo of an ideal pinhole camera: the focal length from the horizontal field of view (radians), the principal
/// point in the middle of the 4:3 image at the top (the Kinect's 1280x1024 shows what 640x480 does, and 64 rows more).
sensor_msgs::CameraInfo defaultCameraInfo(int width, int height, double horizontal_field_of_view);

/// The same from intrinsics, as high as wide (the height is not known).
sensor_msgs::CameraInfo cameraInfoOf(const StreamIntrinsics& intrinsics);

/// A calibration made at another size of the same camera's image: scaled by the width. Calibrations of images without
/// size are of this one.
sensor_msgs::CameraInfo scaledCameraInfo(const sensor_msgs::CameraInfo& calibration, int width, int height);

/// CameraInfo of the projector, as a second camera beside the infrared one, for disparity images: P(0,3) = -fx *
/// baseline.
sensor_msgs::CameraInfo projectorInfo(const sensor_msgs::CameraInfo& infrared, double baseline);

}  // namespace recognition
