#pragma once

#include <memory>
#include <vector>

#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/matching/matching_parameters.h"
#include "rgbd_recognition/matching/scene_matches.h"
#include "rgbd_recognition/verification/verification_parameters.h"

namespace recognition {

/// What a proposer looks at.
struct ProposalContext {
  const SceneView& scene;
  const PreparedModels& models;
  const SceneMatches& matches;  ///< of all objects
  const cv::Mat& explained;     ///< CV_8UC1, depth resolution: not 0 where a detection explains the frame
  MatchingLimits limits;
};

/// Says where objects may be. Immutable; same result for any number of threads.
class PoseProposer {
 public:
  virtual ~PoseProposer() = default;

  /// Hypotheses about what is not explained yet, those of the highest priority first.
  virtual std::vector<Hypothesis> propose(const ProposalContext& context) const = 0;
};

/// What follows Algorithm 2's consensus sets, in order: poses of single correspondences, then resting poses; without
/// those whose number is 0.
std::vector<std::unique_ptr<PoseProposer>> makeProposers(const VerificationParameters& parameters);

}  // namespace recognition
