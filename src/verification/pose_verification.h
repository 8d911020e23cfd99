#pragma once

#include "alignment/depth_buffer.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/matching/matching_parameters.h"
#include "rgbd_recognition/verification/verification_parameters.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"
#include "verification/acceptance_rule.h"
#include "verification/pixel_consistency.h"

namespace recognition {

/// A hypothesis with what its test found out so far.
struct TestedHypothesis {
  VerifiedHypothesis verified;
  ReprojectedModel reprojected;   ///< from TestLevel::kReprojected on
  PixelConsistency pixels;        ///< likewise; `color_ok` is compared where the rule needs it, and of what is accepted
  double coarse_structure = 0.0;  ///< Evidence::structure at half resolution, from TestLevel::kCoarse on
  int inherited_inliers = 0;      ///< of an alternative: the consensus of the hypothesis that it is an alternative to

  bool finished() const { return verified.level == TestLevel::kCompared || verified.rejection != Rejection::kNone; }
};

/// The test of poses in one frame, level by level: each level costs more, and refuses what cannot be accepted any more.
/// With a rule that does not refuse early (the paper's) each hypothesis is refined, reprojected and compared. Safe to
/// use from several threads.
class PoseVerification {
 public:
  /// References must outlive it. `segmentation`: the segments that are left in this round.
  PoseVerification(const VerificationParameters& parameters, const MatchingLimits& limits, const PreparedModels& models,
                   const SceneView& scene, const Segmentation& segmentation, const AcceptanceRule& rule)
      : parameters_(parameters),
        limits_(limits),
        models_(models),
        scene_(scene),
        segmentation_(segmentation),
        rule_(rule) {}

  TestedHypothesis begin(const Hypothesis& hypothesis, int inherited_inliers = 0) const;
  /// Climbs by one level, unless finished.
  void advance(TestedHypothesis* tested) const;
  /// Climbs until finished, or to a level.
  void advanceTo(TestLevel level, TestedHypothesis* tested) const;
  TestedHypothesis test(const Hypothesis& hypothesis) const;

 private:
  void probe(TestedHypothesis* tested) const;
  void refine(TestedHypothesis* tested) const;
  void compareCoarsely(TestedHypothesis* tested) const;
  void reprojectInFull(TestedHypothesis* tested) const;
  void compare(TestedHypothesis* tested) const;
  void matchFeatures(TestedHypothesis* tested) const;
  /// Evidence::peak; refuses as soon as the control poses leave no hope.
  void measurePeak(TestedHypothesis* tested) const;
  /// Whether `most` in place of its evidence would not do either.
  bool isHopeless(VerifiedHypothesis* verified, Evidence most) const;
  void refuseHopeless(VerifiedHypothesis* verified) const;

  const VerificationParameters& parameters_;
  MatchingLimits limits_;
  const PreparedModels& models_;
  const SceneView& scene_;
  const Segmentation& segmentation_;
  const AcceptanceRule& rule_;
};

}  // namespace recognition
