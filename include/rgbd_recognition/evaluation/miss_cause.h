#pragma once

#include <string>

#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/recognizer.h"

namespace recognition {

/// Where on the way through the pipeline an instance was lost.
enum class MissCause {
  kFound,
  kNotTrained,          ///< no model of it in the store
  kSegmentation,        ///< less than a fifth of its visible pixels lie in regions of interest, whatever its features
  kNoFeatures,          ///< fewer than 3 features on it
  kFewCorrespondences,  ///< fewer than 3 features matched to the right place of the right model
  kNoConsensus,         ///< no hypothesis of the object near its pose
  kFailedTest,          ///< a hypothesis near its pose did not pass the reprojection test
  kLostConflict,        ///< it passed, but another hypothesis won the conflict
};
constexpr int kMissCauses = 8;

/// "found", "not_trained", "segmentation", ...
const char* missCauseName(MissCause cause);

/// How near a hypothesis must be to count as one of this instance (the challenge's zero marks).
constexpr double kNearTranslation = 0.03;  ///< metres
constexpr double kNearRotation = 20.0;     ///< degrees
bool isNear(const Pose& a, const Pose& b);

/// What the pipeline had of one true instance.
struct InstanceTrace {
  MissCause cause = MissCause::kNotTrained;
  int visible_pixels = 0;           ///< of the model at its true pose, depth resolution
  double segmented = 0.0;           ///< share of those in regions of interest
  int features = 0;                 ///< scene features on it
  int correct_correspondences = 0;  ///< features matched to within 2 cm of their true place
  int best_consensus = 0;           ///< of hypotheses near its pose
  std::string detail;               ///< for the last two causes: scores, reason, winner
};

/// Follows one true instance through a result. `found`: a detection hit it.
InstanceTrace traceInstance(const RgbdFrame& frame, const RecognitionResult& result, const ModelDatabase& database,
                            int object, const Pose& camera_from_object, bool found);

}  // namespace recognition
