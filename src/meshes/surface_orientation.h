#pragma once

#include <cmath>

#include "rgbd_recognition/core/pose.h"

namespace recognition {

/// Where a keypoint's angle (image, radians) points to, in the object frame and perpendicular to the unit direction of
/// the view; unit length.
inline Eigen::Vector3f surfaceOrientation(float angle, const Eigen::Vector3f& view_direction,
                                          const Pose& object_from_camera) {
  const Eigen::Vector3d in_image(std::cos(angle), std::sin(angle), 0.0);
  const Eigen::Vector3f direction = (object_from_camera.linear() * in_image).cast<float>();
  return (direction - direction.dot(view_direction) * view_direction).normalized();
}

}  // namespace recognition
