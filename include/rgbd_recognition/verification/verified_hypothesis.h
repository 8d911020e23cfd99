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
  double visible = 0.0;     ///< share of the model's near side that is in the image and not hidden, 0..1
  double free_space = 0.0;  ///< share of M_j through which the scene is seen, 0..1
  int best_segment = 0;     ///< label of S*, 0 for none
};

/// How well a hypothesis agrees with the frame in colour.
struct Appearance {
  double structure =
      0.0;  ///< local correlation of model's and frame's lightness over the seen pixels, weighted by contrast, -1..1
  double texture = 0.0;              ///< mean of those weights: 0 where neither has contrast, 1 where all is textured
  double color_distance = 0.0;       ///< mean CIELAB distance left over the seen pixels, capped at 50
  double illumination_change = 0.0;  ///< mean change of chroma that the fitted illumination makes, CIELAB
  /// Sum over the pixels of how well each is explained, -1..1: positive where model and frame agree, negative where the
  /// frame contradicts, 0 where it does not say.
  double gain = 0.0;
};

/// What speaks for a hypothesis beside the paper's measures; the confidence is a function of both.
struct Evidence : Appearance {
  int inliers = 0;   ///< different scene features of the consensus that agree with the pose, in space and in the image
  int features = 0;  ///< scene features on the pixels of consistent depth, and
  int matched = 0;   ///< of these, those that the model has at that place, size and orientation, see matchTexture()
  /// Log-likelihood ratio (nats) of `matched` at the pose against the best of the control poses beside it: how unlikely
  /// it is that so many match by chance on this surface. 0 where they match as well elsewhere.
  double significance = 0.0;
  double peak = 0.0;       ///< correlation of colours at the pose less the best of the control poses', -2..2
  double depth_fit = 0.0;  ///< consistent pixels over consistent and seen-through ones, 0..1
  double seen = 0.0;       ///< consistent pixels, of M_j without its rim
  /// Mean over the pixels of consistent depth of the share of their segment (Sec. IV) that the hypothesis explains, 0
  /// for pixels in none: low where the model lies in a surface that goes on beyond it, as a picture on a table cloth
  /// does. s_o of eq. (14) for an object of several segments, and by depth alone, whatever the illumination.
  double segment_share = 0.0;
};

/// Why a hypothesis was not accepted: the gate that refused it, in the order of the test.
enum class Rejection {
  kNone,           ///< accepted
  kExplained,      ///< better hypotheses explain its features
  kBudget,         ///< the work budget was spent before its turn
  kProbe,          ///< some of the model's points disagree with the frame
  kOutOfView,      ///< nothing of the model is in the image
  kTooLittleSeen,  ///< min_visible
  kFreeSpace,      ///< max_free_space: the scene is seen through the model
  kConsensus,      ///< min_consensus: too few features agree with the refined pose
  kBound,          ///< no appearance could lift its confidence above min_confidence
  kCoarse,         ///< a look at half resolution finds too little likeness
  kIndistinct,     ///< features or colours agree as well beside the pose
  kConsistency,    ///< theta_c of eq. (17), or min_confidence
  kConflict,       ///< another object explains the same pixels or segment better
  kDuplicate       ///< the same object does
};
const char* rejectionName(Rejection rejection);

/// How far a hypothesis climbed. Each level costs more than the one before and bounds the confidence from above.
enum class TestLevel {
  kProposed,     ///< not looked at
  kProbed,       ///< a few points of the model compared with depth
  kRefined,      ///< pose refined
  kCoarse,       ///< compared at half resolution with a quarter of the model's points
  kReprojected,  ///< compared in depth with all points, eq. (10)-(12)
  kCompared      ///< compared in colour and texture as well, eq. (13)-(17)
};
constexpr int kTestLevels = 6;
const char* testLevelName(TestLevel level);

struct VerifiedHypothesis {
  Hypothesis hypothesis;                       ///< as it came
  Pose camera_from_object = Pose::Identity();  ///< refined
  ConsistencyScores scores;
  Evidence evidence;
  double confidence = 0.0;  ///< probability that it is right, 0..1
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< of the pose, in the camera frame: x y z (m), rotation x y z (rad)
  Rejection rejection = Rejection::kNone;   ///< kNone: accepted
  TestLevel level = TestLevel::kProposed;   ///< the last one reached
  std::string conflict_with;                ///< object that won, for kConflict and kDuplicate

  bool accepted() const { return rejection == Rejection::kNone; }
};

}  // namespace recognition
