#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rgbd_recognition/matching/correspondence_search.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/verification/consistency.h"
#include "rgbd_recognition/verification/evidence.h"
#include "rgbd_recognition/verification/prepared_model.h"
#include "rgbd_recognition/verification/scene_view.h"
#include "rgbd_recognition/verification/verification_parameters.h"

namespace rgbd_recognition {

/// Why a hypothesis was not accepted.
enum class Rejection { kNone, kConsistency, kTooLittleSeen, kFreeSpace, kConsensus, kConflict, kDuplicate, kOutOfView };
const char* rejectionName(Rejection rejection);

struct VerifiedHypothesis {
  Hypothesis hypothesis;                       ///< as it came
  Pose camera_from_object = Pose::Identity();  ///< refined
  ConsistencyScores scores;
  Evidence evidence;
  double confidence = 0.0;  ///< probability that it is right, 0..1
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< of the pose, in the camera frame: x y z (m), rotation x y z (rad)
  Rejection rejection = Rejection::kNone;   ///< kNone: accepted
  std::string conflict_with;                ///< object that won, for kConflict and kDuplicate

  bool accepted() const { return rejection == Rejection::kNone; }
};

/// What a round of verification tells hypothesis generation for the next one.
struct RoundOutcome {
  /// All of this round, accepted and rejected; also look-alikes (the object turned, another of its shape) that passed
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
  /// poses that single correspondences, then surfaces suggest where nothing is found:
  /// VerificationParameters::suggestions and shape_suggestions. Throws std::invalid_argument for a hypothesis or
  /// matches whose object or features do not exist.
  RoundOutcome verify(const std::vector<Hypothesis>& hypotheses, int round, const SceneMatches* matches = nullptr);

  /// Everything accepted so far (a later round can take back an earlier choice), by falling confidence.
  std::vector<VerifiedHypothesis> detections() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbd_recognition
