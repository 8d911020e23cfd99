#pragma once

#include <vector>

#include "verification/pose_verification.h"

namespace recognition {

/// The symmetric alternatives of a compared hypothesis whose texture may fit the frame as well as its own or better,
/// tested. They have no consensus of their own; they inherit the number of inliers.
std::vector<TestedHypothesis> testAlternatives(const TestedHypothesis& tested, const PreparedModels& models,
                                               const SceneView& scene, const PoseVerification& verification);

}  // namespace recognition
