#include "verification/confidence.h"

#include <algorithm>
#include <cmath>

namespace recognition {
namespace {

struct Weights {
  double intercept;
  ConfidenceInputs inputs;
};

constexpr Weights kConsensus =
#define RGBD_CONSENSUS_WEIGHTS
#include "verification/confidence_weights.inc"
    ;
#undef RGBD_CONSENSUS_WEIGHTS
constexpr Weights kProposal =
#define RGBD_PROPOSAL_WEIGHTS
#include "verification/confidence_weights.inc"
    ;
#undef RGBD_PROPOSAL_WEIGHTS

constexpr int kManyInliers = 40;
constexpr double kMinPeak = -0.2, kMaxPeak = 0.5;
constexpr int kMaxMatched = 100;           // of features that are not counted yet
constexpr double kMaxSignificance = 20.0;  // likewise
constexpr double kMinColorDistance = 4.0;  // CIELAB, that even a right pose has

}  // namespace

ConfidenceInputs confidenceInputs(const Evidence& evidence) {
  return {std::log1p(evidence.inliers),
          std::min(kManyInliers, evidence.inliers) / 10.0,
          std::log1p(evidence.significance),
          evidence.structure,
          std::clamp(evidence.peak, kMinPeak, kMaxPeak),
          -evidence.color_distance / 10.0,
          evidence.depth_fit,
          evidence.segment_share,
          -evidence.illumination_change / 10.0};
}

double confidence(const Evidence& evidence, HypothesisSource source) {
  const Weights& weights = lacksConsensus(source) ? kProposal : kConsensus;
  const ConfidenceInputs inputs = confidenceInputs(evidence);
  double logit = weights.intercept;
  for (size_t i = 0; i < inputs.size(); ++i) logit += weights.inputs[i] * inputs[i];
  return 1.0 / (1.0 + std::exp(-logit));
}

double confidenceWithFeatures(const VerifiedHypothesis& hypothesis) {
  Evidence best = hypothesis.evidence;
  if (hypothesis.hypothesis.source != HypothesisSource::kConsensus) best.inliers = kMaxMatched;
  best.significance = kMaxSignificance;
  return confidence(best, hypothesis.hypothesis.source);
}

double maxConfidence(const VerifiedHypothesis& hypothesis) {
  const TestLevel level = hypothesis.level;
  Evidence best = hypothesis.evidence;
  if (level < TestLevel::kCompared && hypothesis.hypothesis.source != HypothesisSource::kConsensus)
    best.inliers = kMaxMatched;
  if (level < TestLevel::kCompared) best.significance = std::max(best.significance, kMaxSignificance);
  if (level < TestLevel::kCoarse) {
    best.structure = best.depth_fit = best.segment_share = 1.0;
    best.peak = kMaxPeak;
    best.color_distance = kMinColorDistance;
    best.illumination_change = 0.0;
  }
  return confidence(best, hypothesis.hypothesis.source);
}

double explanatoryStrength(const Evidence& evidence, double confidence) {
  return evidence.gain * -std::log(std::max(1e-9, 1.0 - confidence));
}

}  // namespace recognition
