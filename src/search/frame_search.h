#pragma once

#include <memory>
#include <vector>

#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/matching/matching_parameters.h"
#include "rgbd_recognition/matching/scene_matches.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/search/search_report.h"
#include "rgbd_recognition/verification/verification_parameters.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"

namespace recognition {

/// What a round of the search tells hypothesis generation for the next one.
struct RoundOutcome {
  /// All of this round, accepted and rejected; also symmetric alternatives (the object rotated, another of its shape)
  /// that passed in place of a hypothesis, without a consensus of their own.
  std::vector<VerifiedHypothesis> hypotheses;
  cv::Mat explained;  ///< CV_8UC1, depth resolution: 255 where an accepted detection (of any round) explains the pixel
  std::vector<int> candidates;  ///< objects worth a further round
  bool finished = true;         ///< nothing more to look for
};

/// The search of one frame: hypotheses are tested the best first, coarse to fine; what is accepted explains its pixels,
/// and what they carried is not tested any more; then the proposers look at what is left. Make one a frame.
///
/// With Decision::kPaper each round tests all hypotheses in full, and further rounds follow on the segments that are
/// left (Sec. VI). With Decision::kConfidence one round does all.
class FrameSearch {
 public:
  /// `scene` must outlive the search. `work_ms`: budget, see SearchState. Throws std::invalid_argument for parameters
  /// out of range and for a negative budget.
  FrameSearch(const VerificationParameters& parameters, const MatchingLimits& limits,
              std::shared_ptr<const PreparedModels> models, const SceneView& scene, double work_ms = 0.0);
  /// The same with models that are prepared for it alone.
  FrameSearch(const VerificationParameters& parameters, const ModelDatabase& database, const SceneView& scene);
  ~FrameSearch();

  /// Tests and chooses among `hypotheses` (with those accepted earlier in mind). With the frame's matches of all objects
  /// the proposers follow, unless the paper decides. Throws std::invalid_argument for a hypothesis or matches whose
  /// object or features do not exist, and for a pose that is no rigid motion.
  RoundOutcome run(const std::vector<Hypothesis>& hypotheses, int round, const SceneMatches* matches = nullptr);

  /// Everything accepted so far (a later round can take back an earlier choice), by falling confidence.
  std::vector<VerifiedHypothesis> detections() const;
  const SearchReport& report() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
