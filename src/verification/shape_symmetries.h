#pragma once

#include <vector>

#include <Eigen/Core>

#include "rgbd_recognition/core/pose.h"

namespace rgbd_recognition {

/// Rotations about the principal axes, and half turns across them, that map a surface onto itself within a few
/// `spacing`: where a print that repeats or a weak consensus may have put the object the wrong way round. Without the
/// identity.
std::vector<Pose> findShapeSymmetries(const std::vector<Eigen::Vector3f>& positions, float spacing);

}  // namespace rgbd_recognition
