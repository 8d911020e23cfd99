#include "verification/hypothesis_testing.h"

#include <algorithm>

#include "verification/confidence.h"
#include "alignment/pose_refiner.h"
#include "verification/texture_match.h"
#include "alignment/surface_probe.h"

namespace recognition {
namespace {

constexpr double kInlierDistance = 0.015;  // metres, Delta_d of the matching
constexpr double kInlierAngle = 0.0095;    // radians: 5 pixels of a Kinect's depth

constexpr double kProposalFreeSpace = 0.12;  // most of a pose without a consensus set
constexpr int kMinTextureMatches = 1;                // features that match at their places, of a pose proposed by shape

constexpr size_t kQuickSamples = 400;
constexpr double kQuickSlack = 0.02;   // metres beside epsilon_d
constexpr double kQuickMargin = 0.25;  // beside max_free_space

// Of a pose that a single correspondence proposes, refined, that is worth projecting all of its model. On simulated
// scenes, half of them are below, and one in a hundred of those that would be accepted.
constexpr int kLookPoints = 800;
constexpr double kLookCorrelation = 4.0, kLookFreeSpace = 2.0, kMinLikeness = 1.1;

/// Not worth testing further.
TestedHypothesis refused(const Hypothesis& hypothesis, const Pose& pose, double free_space, Rejection rejection) {
  TestedHypothesis tested;
  tested.verified.hypothesis = hypothesis;
  tested.verified.camera_from_object = pose;
  tested.verified.scores.free_space = free_space;
  tested.verified.rejection = rejection;
  return tested;
}

bool looksAlike(const ProbeResult& look) {
  return look.agreeing - kLookFreeSpace * look.free_space + kLookCorrelation * look.correlation >= kMinLikeness;
}

/// What the depth alone says against a hypothesis.
Rejection geometricRejection(const VerifiedHypothesis& verified, const VerificationParameters& parameters) {
  const ConsistencyScores& scores = verified.scores;
  if (scores.projected == 0) return Rejection::kOutOfView;
  if (scores.visible < parameters.min_visible) return Rejection::kTooLittleSeen;
  if (scores.free_space > parameters.max_free_space) return Rejection::kFreeSpace;
  if (verified.hypothesis.source == HypothesisSource::kShape && verified.evidence.inliers < kMinTextureMatches)
    return Rejection::kConsensus;
  if (lacksConsensus(verified.hypothesis.source))
    return scores.free_space > kProposalFreeSpace ? Rejection::kFreeSpace : Rejection::kNone;
  return verified.evidence.inliers < parameters.min_consensus ? Rejection::kConsensus : Rejection::kNone;
}

/// Share of some of the model's points through which the scene is seen, with room for what refinement may mend.
double sampledFreeSpace(const PreparedModel& model, const Pose& pose, const SceneView& scene, double tolerance) {
  const std::vector<int> points = visiblePoints(model, pose, scene.camera, kQuickSamples);
  int free_space = 0;
  for (const int i : points) {
    const Eigen::Vector3d p = pose * model.positions[static_cast<size_t>(i)].cast<double>();
    const Eigen::Vector2d pixel = scene.camera.project(p);
    const cv::Point m(std::min(cvRound(pixel.x()), scene.depth.cols - 1),
                      std::min(cvRound(pixel.y()), scene.depth.rows - 1));
    free_space += scene.depth.at<float>(m) > p.z() + tolerance;
  }
  return free_space / std::max(1.0, static_cast<double>(points.size()));
}

/// Scores of one pose by depth.
TestedHypothesis scoreDepth(const Hypothesis& hypothesis, const Pose& pose, const ObjectModel& object,
                            const PreparedModel& model, const SceneView& scene, const Segmentation& segmentation,
                            const VerificationParameters& parameters) {
  TestedHypothesis tested;
  VerifiedHypothesis& verified = tested.verified;
  verified.hypothesis = hypothesis;
  verified.camera_from_object = pose;
  tested.reprojected = reproject(model, pose, scene.camera);
  if (tested.reprojected.pixels == 0) return tested;
  tested.pixels.state = testDepth(tested.reprojected, scene, parameters);
  tested.pixels.color_ok = cv::Mat(tested.reprojected.box.size(), CV_8UC1, cv::Scalar(0));
  verified.scores = consistencyScores(tested.pixels, tested.reprojected.box, segmentation, parameters.w_c);
  const double pixels = kInlierAngle * scene.camera.fx;
  verified.evidence.inliers = countInliers(hypothesis, object, pose, scene, kInlierDistance, pixels);
  verified.evidence.segment_share =
      segmentShare(tested.pixels.state, tested.reprojected.box, *scene.segmentation);  // of all rounds
  return tested;
}

/// A symmetric alternative or a proposal has no consensus of its own: the object's texture at its very places must speak for it
/// instead.
void scoreTexture(const ObjectModel& object, const PreparedModel& model, const SceneView& scene,
                TestedHypothesis* tested) {
  const auto features = object.features.find(scene.features->image.type);
  if (features == object.features.end()) return;
  VerifiedHypothesis& verified = tested->verified;
  const TextureMatch texture = matchTexture(features->second, model.feature_grids.at(features->first),
                                      verified.camera_from_object, tested->reprojected, tested->pixels.state, scene);
  verified.evidence.features = texture.features;
  verified.evidence.matched = texture.matched;
}

/// Adds what colour says.
void scoreColor(const PreparedModel& model, const SceneView& scene, const Segmentation& segmentation,
                const VerificationParameters& parameters, TestedHypothesis* tested) {
  VerifiedHypothesis& verified = tested->verified;
  ColorTransform illumination;
  if (parameters.illumination_compensation) illumination = fitIllumination(tested->reprojected, tested->pixels.state, model, scene);
  tested->pixels.color_ok = testColor(tested->reprojected, model, illumination, scene, parameters);
  verified.scores = consistencyScores(tested->pixels, tested->reprojected.box, segmentation, parameters.w_c);
  const Evidence before = verified.evidence;
  verified.evidence = weighAppearance(tested->reprojected, tested->pixels, model, illumination, scene);
  verified.evidence.inliers = before.inliers;
  verified.evidence.features = before.features;
  verified.evidence.matched = before.matched;
  verified.evidence.segment_share = before.segment_share;
}

}  // namespace

TestedHypothesis testHypothesis(const Hypothesis& hypothesis, const ObjectModel& object, const PreparedModel& model,
                                const SceneView& scene, const Segmentation& segmentation,
                                const VerificationParameters& parameters, double theta_c, int inliers) {
  const bool by_paper = parameters.decision == Decision::kPaper;
  Pose pose = hypothesis.camera_from_object;
  if (!by_paper) {
    const double free_space = sampledFreeSpace(model, pose, scene, parameters.epsilon_d + kQuickSlack);
    if (free_space > parameters.max_free_space + kQuickMargin)
      return refused(hypothesis, pose, free_space, Rejection::kFreeSpace);
  }
  Matrix6d covariance = Matrix6d::Zero();
  if (parameters.refine) {
    RefinementOptions options;
    options.iterations = parameters.refine_iterations;
    const Refinement refinement = refinePose(model, object, hypothesis, pose, scene, options);
    pose = refinement.camera_from_object;
    covariance = refinement.covariance;
  }
  if (!by_paper && hypothesis.source == HypothesisSource::kCorrespondence) {
    const ProbeResult look = probeSurface(model, kLookPoints, pose, scene);
    if (!looksAlike(look)) return refused(hypothesis, pose, look.free_space, Rejection::kConsistency);
  }
  TestedHypothesis tested = scoreDepth(hypothesis, pose, object, model, scene, segmentation, parameters);
  VerifiedHypothesis& verified = tested.verified;
  verified.covariance = covariance;
  if (!by_paper && hypothesis.source != HypothesisSource::kConsensus && tested.reprojected.pixels > 0) {
    scoreTexture(object, model, scene, &tested);
    const int matched = verified.evidence.matched;
    const bool inherits = hypothesis.source == HypothesisSource::kAlternative && matched >= parameters.min_consensus;
    verified.evidence.inliers = inherits ? std::min(inliers, matched) : matched;
  }
  verified.rejection = geometricRejection(verified, parameters);
  if (verified.scores.projected == 0 || (!by_paper && !verified.accepted())) return tested;
  if (!by_paper && maxConfidence(verified.evidence, hypothesis.source) < parameters.candidateConfidence()) {
    verified.rejection = Rejection::kConsistency;  // whatever its colours
    return tested;
  }
  scoreColor(model, scene, segmentation, parameters, &tested);
  if (by_paper) {
    verified.confidence = std::min(1.0, verified.scores.total);
    verified.rejection = verified.scores.total >= theta_c ? Rejection::kNone : Rejection::kConsistency;  // eq. (17)
    return tested;
  }
  verified.confidence = confidence(verified.evidence, hypothesis.source);
  if (verified.accepted() && verified.confidence < parameters.min_confidence)
    verified.rejection = Rejection::kConsistency;
  return tested;
}

}  // namespace recognition
