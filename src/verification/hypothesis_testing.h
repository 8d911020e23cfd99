#pragma once

#include "rgbd_recognition/verification/verified_hypothesis.h"
#include "verification/pixel_consistency.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"

namespace recognition {

/// A hypothesis with what its test found out pixel by pixel.
struct TestedHypothesis {
  VerifiedHypothesis verified;
  ReprojectedModel reprojected;
  PixelConsistency pixels;
};

/// Refines a hypothesis and tests it alone: all scores, and every reason for rejection but conflicts and duplicates.
/// Unless the paper decides, what its depth alone refuses is neither refined (much free space) nor compared in colour,
/// nor is what no colour could save; what a single correspondence proposes is given up where a quick look finds no
/// likeness. Scores that were not needed are 0 then. `inliers` is the consensus that a symmetric alternative inherits.
/// `segmentation` are the segments that are left in this round, `theta_c` the threshold of eq. (17) in it.
TestedHypothesis testHypothesis(const Hypothesis& hypothesis, const ObjectModel& object, const PreparedModel& model,
                                const SceneView& scene, const Segmentation& segmentation,
                                const VerificationParameters& parameters, double theta_c, int inliers = 0);

}  // namespace recognition
