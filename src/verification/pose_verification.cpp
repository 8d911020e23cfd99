#include "verification/pose_verification.h"

#include <algorithm>
#include <utility>

#include "alignment/control_poses.h"
#include "alignment/pose_refiner.h"
#include "alignment/surface_probe.h"
#include "verification/evidence.h"
#include "verification/texture_match.h"

namespace recognition {
namespace {

constexpr double kInlierAngle = 0.0095;  // radians: 5 pixels of a Kinect's depth

// Gates of the levels, each with the room that later levels may gain: chosen by eye. How many of the hypotheses that the
// exhaustive test accepts they refuse: doc/results.md.
constexpr int kProbePoints = 120;
constexpr int kPeakPoints = 800;
constexpr double kProbeMargin = 0.25;      // of free space beside max_free_space: refinement moves the pose
constexpr double kRefinedMargin = 0.10;    // the same for the refined pose
constexpr int kMinCoarsePixels = 250;      // of the reprojected model at half resolution; of fewer it says too little
constexpr double kCoarseStructure = 0.15;  // that full resolution may gain
constexpr double kCoarseDistance = 4.0;    // CIELAB, likewise
constexpr double kCoarseDepthFit = 0.04;   // likewise
constexpr double kCoarseSegmentShare = 0.06;  // likewise

/// The evidence with the most that colours, depth and segments could still say.
Evidence withBestAppearance(Evidence evidence) {
  evidence.structure = evidence.depth_fit = evidence.segment_share = 1.0;
  evidence.color_distance = evidence.illumination_change = 0.0;
  return evidence;
}

}  // namespace

TestedHypothesis PoseVerification::begin(const Hypothesis& hypothesis, int inherited_inliers) const {
  TestedHypothesis tested;
  tested.verified.hypothesis = hypothesis;
  tested.verified.camera_from_object = hypothesis.camera_from_object;
  tested.inherited_inliers = inherited_inliers;
  return tested;
}

void PoseVerification::advance(TestedHypothesis* tested) const {
  if (tested->finished()) return;
  TestLevel& level = tested->verified.level;
  level = static_cast<TestLevel>(static_cast<int>(level) + 1);
  switch (level) {
    case TestLevel::kProposed:
      return;
    case TestLevel::kProbed:
      return probe(tested);
    case TestLevel::kRefined:
      return refine(tested);
    case TestLevel::kCoarse:
      return compareCoarsely(tested);
    case TestLevel::kReprojected:
      return reprojectInFull(tested);
    case TestLevel::kCompared:
      return compare(tested);
  }
}

void PoseVerification::advanceTo(TestLevel level, TestedHypothesis* tested) const {
  while (!tested->finished() && tested->verified.level < level) advance(tested);
}

TestedHypothesis PoseVerification::test(const Hypothesis& hypothesis) const {
  TestedHypothesis tested = begin(hypothesis);
  advanceTo(TestLevel::kCompared, &tested);
  return tested;
}

void PoseVerification::probe(TestedHypothesis* tested) const {
  VerifiedHypothesis& verified = tested->verified;
  if (!rule_.refusesEarly()) return;
  const ProbeResult look =
      probeSurface(models_.at(verified.hypothesis.object), kProbePoints, verified.camera_from_object, scene_);
  verified.scores.free_space = look.free_space;
  if (look.facing == 0 || look.outside >= 1.0)
    verified.rejection = Rejection::kOutOfView;
  else if (look.free_space > parameters_.max_free_space + kProbeMargin)
    verified.rejection = Rejection::kProbe;
}

void PoseVerification::refine(TestedHypothesis* tested) const {
  VerifiedHypothesis& verified = tested->verified;
  const int object = verified.hypothesis.object;
  if (parameters_.refine) {
    RefinementOptions options;
    options.iterations = parameters_.refine_iterations;
    const Refinement refinement = refinePose(models_.at(object), models_.object(object), verified.hypothesis,
                                             verified.camera_from_object, scene_, options);
    verified.camera_from_object = refinement.camera_from_object;
    verified.covariance = refinement.covariance;
  }
  const bool has_consensus = verified.hypothesis.source == HypothesisSource::kConsensus;
  if (has_consensus)
    verified.evidence.inliers = countInliers(verified.hypothesis, models_.object(object), verified.camera_from_object,
                                             scene_, limits_.delta_d, kInlierAngle * scene_.camera.fx);
  if (!rule_.refusesEarly()) return;
  const ProbeResult look = probeSurface(models_.at(object), kProbePoints, verified.camera_from_object, scene_);
  verified.scores.free_space = look.free_space;
  if (look.free_space > parameters_.max_free_space + kRefinedMargin) verified.rejection = Rejection::kProbe;
  if (has_consensus && verified.evidence.inliers < parameters_.min_consensus)
    verified.rejection = Rejection::kConsensus;
}

void PoseVerification::compareCoarsely(TestedHypothesis* tested) const {
  VerifiedHypothesis& verified = tested->verified;
  if (parameters_.decision == Decision::kPaper) return;
  measurePeak(tested);
  if (tested->finished() || !rule_.refusesEarly() || !scene_.half) return;
  const SceneView& half = *scene_.half;
  const ModelCloud& cloud = models_.at(verified.hypothesis.object).coarse;
  const ReprojectedModel reprojected = reproject(cloud, verified.camera_from_object, half.camera);
  if (reprojected.pixels < kMinCoarsePixels) return;
  const cv::Mat state = testDepth(reprojected, half, parameters_);
  const PosedModel posed(cloud, reprojected, state, half, AppearanceScale::ofHalf());
  Evidence best = withBestAppearance(verified.evidence);
  best.depth_fit = std::min(1.0, depthFit(posed).fit + kCoarseDepthFit);
  best.segment_share =
      std::min(1.0, segmentShare(state, reprojected.box, *scene_.segmentation, 2) + kCoarseSegmentShare);
  if (isHopeless(&verified, best)) {  // whatever its colours
    verified.rejection = Rejection::kCoarse;
    return;
  }
  ColorTransform illumination;
  if (parameters_.illumination_compensation) illumination = fitIllumination(posed);
  const Appearance coarse = weighAppearance(posed, illumination);
  tested->coarse_structure = coarse.structure;
  best.structure = std::min(1.0, coarse.structure + kCoarseStructure);
  best.color_distance = std::max(0.0, coarse.color_distance - kCoarseDistance);
  if (isHopeless(&verified, best)) verified.rejection = Rejection::kCoarse;
}

void PoseVerification::reprojectInFull(TestedHypothesis* tested) const {
  VerifiedHypothesis& verified = tested->verified;
  const PreparedModel& model = models_.at(verified.hypothesis.object);
  tested->reprojected = reproject(model, verified.camera_from_object, scene_.camera);
  if (tested->reprojected.pixels > 0) {
    tested->pixels.state = testDepth(tested->reprojected, scene_, parameters_);
    tested->pixels.color_ok = cv::Mat(tested->reprojected.box.size(), CV_8UC1, cv::Scalar(0));
    verified.scores = consistencyScores(tested->pixels, tested->reprojected.box, segmentation_, parameters_.w_c);
    const ProbeResult look = probeSurface(model, kProbePoints, verified.camera_from_object, scene_);
    verified.scores.visible *= 1.0 - look.outside;
    verified.evidence.segment_share =
        segmentShare(tested->pixels.state, tested->reprojected.box, *scene_.segmentation);  // of all rounds
  }
  verified.rejection = rule_.byDepth(verified);
  refuseHopeless(&verified);
}

void PoseVerification::matchFeatures(TestedHypothesis* tested) const {
  VerifiedHypothesis& verified = tested->verified;
  const ObjectModel& object = models_.object(verified.hypothesis.object);
  Evidence& evidence = verified.evidence;
  const auto features = object.features.find(scene_.features->image.type);
  if (features == object.features.end()) return;
  const TextureMatch texture =
      matchTexture(features->second, verified.camera_from_object, tested->reprojected, tested->pixels.state, scene_);
  evidence.features = texture.features;
  evidence.matched = texture.matched;
  evidence.significance = texture.significance;
  if (verified.hypothesis.source == HypothesisSource::kConsensus) return;
  // A hypothesis without a consensus of its own: the object's texture at its very places must speak for it instead.
  const bool inherits =
      verified.hypothesis.source == HypothesisSource::kAlternative && texture.matched >= parameters_.min_consensus;
  evidence.inliers = inherits ? std::min(tested->inherited_inliers, texture.matched) : texture.matched;
}

void PoseVerification::compare(TestedHypothesis* tested) const {
  VerifiedHypothesis& verified = tested->verified;
  const PreparedModel& model = models_.at(verified.hypothesis.object);
  Evidence& evidence = verified.evidence;
  const bool features_first = rule_.refusesEarly() && lacksConsensus(verified.hypothesis.source);
  if (features_first) {  // they cost less than colours, and refuse most of what few features or none propose
    matchFeatures(tested);
    verified.rejection = rule_.byFeatures(verified);
    if (!verified.accepted()) return;
  }
  const PosedModel posed(model, tested->reprojected, tested->pixels.state, scene_);
  ColorTransform illumination;
  if (parameters_.illumination_compensation) illumination = fitIllumination(posed);
  static_cast<Appearance&>(evidence) = weighAppearance(posed, illumination);
  const DepthFit depth = depthFit(posed);
  evidence.depth_fit = depth.fit;
  evidence.seen = depth.seen;
  const bool needs_colors = parameters_.decision == Decision::kPaper;
  if (!needs_colors) {
    if (rule_.refusesEarly() && !rule_.mayBecomeAccepted(verified)) {
      verified.rejection = Rejection::kBound;
      return;
    }
    if (!features_first) matchFeatures(tested);
    rule_.decide(&verified);
    if (!verified.accepted()) return;
  }
  tested->pixels.color_ok = testColor(tested->reprojected, model, illumination, scene_, parameters_);
  const double visible = verified.scores.visible;
  verified.scores = consistencyScores(tested->pixels, tested->reprojected.box, segmentation_, parameters_.w_c);
  verified.scores.visible = visible;
  if (needs_colors) rule_.decide(&verified);
}

void PoseVerification::measurePeak(TestedHypothesis* tested) const {
  VerifiedHypothesis& verified = tested->verified;
  const auto hopeless = [&](double peak) {
    verified.evidence.peak = peak;
    if (!rule_.refusesEarly()) return false;
    verified.rejection = rule_.byPeak(verified);
    if (verified.accepted() && isHopeless(&verified, withBestAppearance(verified.evidence)))
      verified.rejection = Rejection::kCoarse;
    return !verified.accepted();
  };
  ProbeLimits limits;
  // White that is overexposed says nothing of where a consensus set is. What lacks one is judged by all colours, as its
  // weights were fitted.
  limits.drops_clipped = !lacksConsensus(verified.hypothesis.source);
  colorPeak(models_.at(verified.hypothesis.object), kPeakPoints, verified.camera_from_object, scene_, limits, hopeless);
}

bool PoseVerification::isHopeless(VerifiedHypothesis* verified, Evidence most) const {
  std::swap(verified->evidence, most);
  const double bound = rule_.bound(*verified);
  std::swap(verified->evidence, most);
  return bound < parameters_.min_confidence;
}

void PoseVerification::refuseHopeless(VerifiedHypothesis* verified) const {
  if (!verified->accepted() || !rule_.refusesEarly()) return;
  Evidence most = verified->evidence;  // colours are still to be compared
  most.structure = most.depth_fit = 1.0;
  most.color_distance = most.illumination_change = 0.0;
  if (isHopeless(verified, most)) verified->rejection = Rejection::kBound;
}

}  // namespace recognition
