#pragma once

#include <Eigen/Geometry>

namespace recognition {

/// Rigid transform, eq. (1). Named `target_from_source`: p_target = target_from_source * p_source (metres).
/// The paper's ^s_o T (scene from object) is `camera_from_object` here.
using Pose = Eigen::Isometry3d;

/// Angle of the rotation between two poses, in radians, 0 to pi.
inline double rotationDistance(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

/// Distance of the two origins, in metres.
inline double translationDistance(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

}  // namespace recognition
