#include "rgbd_recognition/verification/hypothesis_test.h"

#include "rgbd_recognition/verification/confidence.h"
#include "rgbd_recognition/verification/pose_refiner.h"
#include "rgbd_recognition/verification/print_match.h"

namespace rgbd_recognition {
namespace {

constexpr double kInlierDistance = 0.015;  // metres, Delta_d of the matching
constexpr double kInlierPixels = 5.0;      // depth pixels

Rejection decideByPaper(const ConsistencyScores& scores, double theta_c) {
  if (scores.projected == 0) return Rejection::kOutOfView;
  return scores.total >= theta_c ? Rejection::kNone : Rejection::kConsistency;  // eq. (17)
}

Rejection decideByConfidence(const VerifiedHypothesis& verified, const VerificationParameters& parameters) {
  const ConsistencyScores& scores = verified.scores;
  if (scores.projected == 0) return Rejection::kOutOfView;
  if (scores.visible < parameters.min_visible) return Rejection::kTooLittleSeen;
  if (scores.free_space > parameters.max_free_space) return Rejection::kFreeSpace;
  if (verified.evidence.inliers < parameters.min_consensus) return Rejection::kConsensus;
  return verified.confidence >= parameters.min_confidence ? Rejection::kNone : Rejection::kConsistency;
}

/// Fills all but the rejection for one pose.
TestedHypothesis scorePose(const Hypothesis& hypothesis, const Pose& pose, const ObjectModel& object,
                           const PreparedModel& model, const SceneView& scene, const Segmentation& segmentation,
                           const VerificationParameters& parameters) {
  TestedHypothesis tested;
  VerifiedHypothesis& verified = tested.verified;
  verified.hypothesis = hypothesis;
  verified.camera_from_object = pose;
  tested.reprojected = reproject(model, pose, scene.camera);
  if (tested.reprojected.pixels == 0) return tested;
  tested.pixels.state = testDepth(tested.reprojected, scene, parameters);
  ColorTransform light;
  if (parameters.light_compensation) light = fitLight(tested.reprojected, tested.pixels.state, model, scene);
  tested.pixels.color_ok = testColor(tested.reprojected, model, light, scene, parameters);
  verified.scores = consistencyScores(tested.pixels, tested.reprojected.box, segmentation, parameters.w_c);
  verified.evidence = weighAppearance(tested.reprojected, tested.pixels, model, light, scene, &tested.explanation);
  const auto features = object.features.find(scene.features->image.type);
  if (features != object.features.end()) {
    const PrintMatch print = matchPrint(features->second, model.feature_grids.at(features->first), pose, tested.reprojected,
                                        tested.pixels.state, scene);
    verified.evidence.features = print.features;
    verified.evidence.matched = print.matched;
  }
  verified.evidence.inliers = countInliers(hypothesis, object, pose, scene, kInlierDistance, kInlierPixels);
  return tested;
}

}  // namespace

TestedHypothesis testHypothesis(const Hypothesis& hypothesis, const ObjectModel& object, const PreparedModel& model,
                                const SceneView& scene, const Segmentation& segmentation,
                                const VerificationParameters& parameters, double theta_c, int inliers) {
  Pose pose = hypothesis.camera_from_object;
  Matrix6d covariance = Matrix6d::Zero();
  if (parameters.refine) {
    RefinementOptions options;
    options.iterations = parameters.refine_iterations;
    const Refinement refinement = refinePose(model, object, hypothesis, pose, scene, options);
    pose = refinement.camera_from_object;
    covariance = refinement.covariance;
  }
  TestedHypothesis tested = scorePose(hypothesis, pose, object, model, scene, segmentation, parameters);
  VerifiedHypothesis& verified = tested.verified;
  verified.covariance = covariance;
  if (inliers >= 0)  // a look-alike: nothing without some print of its own
    verified.evidence.inliers = verified.evidence.matched >= parameters.min_consensus ? inliers : verified.evidence.matched;
  if (parameters.decision == Decision::kPaper) {
    verified.confidence = std::min(1.0, verified.scores.total);
    verified.rejection = decideByPaper(verified.scores, theta_c);
  } else {
    verified.confidence = confidence(verified.evidence);
    verified.rejection = decideByConfidence(verified, parameters);
  }
  return tested;
}

}  // namespace rgbd_recognition
