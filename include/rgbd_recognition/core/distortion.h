#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/core/frame.h"

namespace recognition {

/// Lens distortion of a camera, by the names and in the order of ROS's camera_info and of OpenCV.
struct Distortion {
  std::string model = "plumb_bob";   ///< or "rational_polynomial"; "equidistant", also named "fisheye"
  std::vector<double> coefficients;  ///< k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4]]]; k1 k2 k3 k4 of equidistant

  /// Whether it changes anything.
  bool isThere() const;

  /// Throws std::invalid_argument that names a model which is not known, or has another number of coefficients.
  void validate() const;

  /// Where the ideal image point (x, y) = (X/Z, Y/Z) is seen.
  Eigen::Vector2d apply(const Eigen::Vector2d& ideal) const;
};

/// The frame as the pinhole camera `rectified` would have taken it. Colour is interpolated; depth takes the nearest
/// pixel, or stays as it is with `depth_is_rectified`. The result owns its pixels. `frame.color_camera` is the
/// distorted camera's. Throws std::invalid_argument for a distortion that does not validate.
RgbdFrame undistorted(const RgbdFrame& frame, const Distortion& distortion, const CameraModel& rectified,
                      bool depth_is_rectified = false);

}  // namespace recognition
