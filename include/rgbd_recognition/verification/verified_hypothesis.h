#pragma once

#include <string>

#include <Eigen/Core>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/matching/hypothesis.h"

namespace recognition {

/// The measures of eq. (12)-(17), and how much of the model is seen.
struct ConsistencyScores {
  double s_d = 0.0;         ///< eq. (12)
  double s_c = 0.0;         ///< eq. (13)
  double s_o = 0.0;         ///< eq. (14)
  double total = 0.0;       ///< left side of eq. (17)
  int projected = 0;        ///< |M_j|, pixels
  double visible = 0.0;     ///< share of M_j that is not hidden by something nearer, 0..1
  double free_space = 0.0;  ///< share of M_j through which the scene is seen, 0..1
  int best_segment = 0;     ///< label of S*, 0 for none
};

/// What speaks for a hypothesis beside the paper's measures; the confidence is a function of both.
struct Evidence {
  int inliers = 0;  ///< different scene features of the consensus that agree with the pose, in space and in the image
  int features = 0;  ///< of a symmetric alternative: scene features on the seen pixels, and
  int matched = 0;   ///< of these, those that the model has at that place, see matchTexture()
  double structure =
      0.0;  ///< local correlation of model's and frame's lightness over the seen pixels, weighted by contrast, -1..1
  double texture = 0.0;         ///< mean of those weights: 0 where neither has contrast, 1 where all is texture
  double color_distance = 0.0;  ///< mean CIELAB distance left over the seen pixels, capped at 50
  double illumination_change = 0.0;    ///< mean change of chroma that the fitted illumination makes, CIELAB
  double depth_fit = 0.0;       ///< consistent pixels over consistent and seen-through ones, 0..1
  double seen = 0.0;            ///< consistent pixels, of M_j without its rim
  /// Mean over the pixels of consistent depth of the share of their segment (Sec. IV) that the hypothesis explains, 0
  /// for pixels in none: low where the model lies in a surface that goes on beyond it, as texture on a table cloth makes
  /// it. s_o of eq. (14) for an object of several segments, and by depth alone, whatever the illumination.
  double segment_share = 0.0;
  /// Sum over the pixels of how well each is explained, -1..1: positive where model and frame agree, negative where the
  /// frame contradicts, 0 where it does not say.
  double gain = 0.0;
};

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

}  // namespace recognition
