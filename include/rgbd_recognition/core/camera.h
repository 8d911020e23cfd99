#pragma once

#include <Eigen/Core>

namespace recognition {

/// Pinhole camera of a rectified image, eq. (2): m ~ C p with C = [fx 0 cx; 0 fy cy; 0 0 1].
///
/// Points are in the camera's optical frame (REP 103: x right, y down, z forward), in metres; image coordinates
/// in pixels, integers at pixel centres.
struct CameraModel {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;

  /// Image coordinates of a point with z > 0 in the optical frame.
  Eigen::Vector2d project(const Eigen::Vector3d& p) const { return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy}; }

  /// The point seen at pixel (u, v) with depth z (distance along the optical axis, metres).
  Eigen::Vector3d unproject(double u, double v, double z) const { return {(u - cx) / fx * z, (v - cy) / fy * z, z}; }

  /// The same camera with an image `factor` times as wide and high.
  CameraModel scaled(double factor) const;

  /// Throws std::invalid_argument that names the offending field and its value.
  void validate() const;
};

}  // namespace recognition
