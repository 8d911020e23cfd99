#pragma once

#include <memory>
#include <string>
#include <vector>

#include "matching/correspondence_search.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/model/object_model.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/verification/verification_parameters.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"
#include "rgbd_recognition/matching/scene_matches.h"

namespace recognition {

/// What a round of verification tells hypothesis generation for the next one.
struct RoundOutcome {
  /// All of this round, accepted and rejected; also symmetric alternatives (the object turned, another of its shape) that passed
  /// in place of a hypothesis, without a consensus of their own.
  std::vector<VerifiedHypothesis> hypotheses;
  cv::Mat explained;  ///< CV_8UC1, depth resolution: 255 where an accepted detection (of any round) explains the pixel
  std::vector<int> candidates;  ///< objects worth a further round
  bool finished = true;         ///< nothing more to look for
};

/// Sec. VI: keeps the state of one frame over its rounds. Make one a frame; cheap to make.
class HypothesisVerifier {
 public:
  /// References must outlive the verifier.
  HypothesisVerifier(const VerificationParameters& parameters, const ModelDatabase& database, const SceneView& scene);
  /// The same with models that were prepared once for all frames.
  HypothesisVerifier(const VerificationParameters& parameters, std::shared_ptr<const PreparedModels> models,
                     const SceneView& scene);
  ~HypothesisVerifier();

  /// Refines, tests and chooses among `hypotheses` (with those accepted earlier in mind). Round 0 uses theta_c, further
  /// rounds theta_c / 2. With the frame's matches of all objects (those of the first round will do), it also tests the
  /// poses that single correspondences, then surfaces propose where nothing is found:
  /// VerificationParameters::correspondence_proposals and resting_proposals. Throws std::invalid_argument for a hypothesis or
  /// matches whose object or features do not exist.
  RoundOutcome verify(const std::vector<Hypothesis>& hypotheses, int round, const SceneMatches* matches = nullptr);

  /// Everything accepted so far (a later round can take back an earlier choice), by falling confidence.
  std::vector<VerifiedHypothesis> detections() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
