#pragma once

#include <vector>

#include "rgbd_recognition/verification/hypothesis_test.h"

namespace rgbd_recognition {

/// The look-alikes of a tested hypothesis whose print may fit the frame as well as its own or better, refined and
/// tested. They have no consensus of their own; the number of inliers is that of the hypothesis.
std::vector<TestedHypothesis> testAlternatives(const TestedHypothesis& tested, const PreparedModels& models,
                                               const SceneView& scene, const Segmentation& segmentation,
                                               const VerificationParameters& parameters);

}  // namespace rgbd_recognition
