#pragma once

#include <vector>

#include "verification/hypothesis_testing.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"

namespace recognition {

/// The symmetric alternatives of a tested hypothesis whose texture may fit the frame as well as its own or better, refined and
/// tested. They have no consensus of their own; the number of inliers is that of the hypothesis.
std::vector<TestedHypothesis> testAlternatives(const TestedHypothesis& tested, const PreparedModels& models,
                                               const SceneView& scene, const Segmentation& segmentation,
                                               const VerificationParameters& parameters);

}  // namespace recognition
