#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "rgbd_recognition/core/pose.h"

namespace recognition {

/// Least-squares rigid transform between corresponding points (Umeyama, PAMI 1991, without scale; the paper's [20]).
///
/// Minimises sum |target_i - T source_i|^2; never a reflection. Nothing if fewer than 3 points, or if the
/// second-largest standard deviation of the points is not above `min_spread` (metres): points on a line leave a
/// rotation open. Throws std::invalid_argument if the numbers of points differ.
std::optional<Pose> rigidTransform(const std::vector<Eigen::Vector3d>& source,
                                   const std::vector<Eigen::Vector3d>& target, double min_spread);

/// The same for points that may lie on a line or in one place: rotations that each pair proposes by itself take part,
/// each like points `lever` metres from its own on all axes. Nothing for no points.
std::optional<Pose> rigidTransform(const std::vector<Eigen::Vector3d>& source,
                                   const std::vector<Eigen::Vector3d>& target,
                                   const std::vector<Eigen::Quaternionf>& rotations, double lever);

using Triangle = std::array<Eigen::Vector3f, 3>;

/// rigidTransform() of three points in closed form, for RANSAC's samples: planes and normals onto one another, then the
/// best turn in the plane (Horn, JOSA A 1987, Sec. 5).
std::optional<Pose> triangleTransform(const Triangle& source, const Triangle& target, double min_spread);

/// For triangles that leave a rotation open: the mean of the rotations that their corners propose, and of the places.
Pose meanTransform(const Triangle& source, const Triangle& target, const std::array<Eigen::Quaternionf, 3>& rotations);

}  // namespace recognition
