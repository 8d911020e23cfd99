#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "rgbd_recognition/core/pose.h"

namespace recognition {

/// Least-squares rigid transform between corresponding points (Umeyama, PAMI 1991, without scale; the paper's [20]).
///
/// Minimises sum |target_i - T source_i|^2; never a reflection. Nothing if fewer than 3 points, or if the
/// second-largest standard deviation of the points is not above `min_spread` (metres): points on a line leave a
/// rotation open. Throws std::invalid_argument if the numbers of points differ.
std::optional<Pose> rigidTransform(const std::vector<Eigen::Vector3d>& source,
                                   const std::vector<Eigen::Vector3d>& target, double min_spread);

using Triangle = std::array<Eigen::Vector3f, 3>;

/// rigidTransform() of three points in closed form, for RANSAC's samples: planes and normals onto one another, then the
/// best turn in the plane (Horn, JOSA A 1987, Sec. 5).
std::optional<Pose> triangleTransform(const Triangle& source, const Triangle& target, double min_spread);

}  // namespace recognition
