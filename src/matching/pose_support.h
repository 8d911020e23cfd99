#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "rgbd_recognition/matching/hypothesis.h"

namespace recognition {

/// How many other correspondences propose about the same pose: each alone proposes one, by its features' places and
/// orientations, and those of the true pose put the object's centre in about one place, while the wrong ones scatter.
///
/// Ours, beyond the paper: Algorithm 2 fixes the best supported correspondences first, and so needs few of them. Linear
/// in the number of correspondences as long as they scatter.
///
/// `rotations` as impliedRotations() gives them, one a pair; `radius`: of places of the centre that agree, metres;
/// `max_rotation`: between rotations that agree, degrees. Pairs that share a scene feature support one another once at
/// most.
std::vector<int> poseSupport(const std::vector<Correspondence>& pairs, const std::vector<Eigen::Quaternionf>& rotations,
                             const std::vector<Eigen::Vector3f>& scene_points,
                             const std::vector<Eigen::Vector3f>& model_points, double radius, double max_rotation);

/// The pairs by falling support; equal ones stay in order.
std::vector<Correspondence> sortBySupport(const std::vector<Correspondence>& pairs, const std::vector<int>& support);

}  // namespace recognition
