#include "verification/confidence.h"

#include <algorithm>
#include <cmath>

namespace recognition {
namespace {

constexpr int kMaxInliers = 1000;  // of what is not counted yet
constexpr double kIntercept = -13.09;
constexpr ConfidenceInputs kWeights = {2.82, 2.72, -1.92, -0.76, 2.12, 5.26, 1.13};
constexpr double kProposalIntercept = -16.70;
constexpr ConfidenceInputs kProposalWeights = {0.31, 3.37, -2.76, -1.09, 3.08, 13.93, 5.65};

double logistic(double intercept, const ConfidenceInputs& weights, const ConfidenceInputs& inputs) {
  double logit = intercept;
  for (size_t i = 0; i < inputs.size(); ++i) logit += weights[i] * inputs[i];
  return 1.0 / (1.0 + std::exp(-logit));
}

}  // namespace

ConfidenceInputs confidenceInputs(const Evidence& evidence) {
  return {std::log1p(evidence.inliers), evidence.structure, evidence.color_distance / 10.0,
          evidence.illumination_change / 10.0, evidence.depth_fit, evidence.segment_share, evidence.texture};
}

double confidence(const Evidence& evidence, HypothesisSource source) {
  const ConfidenceInputs inputs = confidenceInputs(evidence);
  return lacksConsensus(source) ? logistic(kProposalIntercept, kProposalWeights, inputs)
                              : logistic(kIntercept, kWeights, inputs);
}

double maxConfidence(const VerifiedHypothesis& hypothesis) {
  const Evidence& known = hypothesis.evidence;
  Evidence best = known;
  if (hypothesis.level < TestLevel::kReprojected) {
    if (hypothesis.hypothesis.source != HypothesisSource::kConsensus) best.inliers = kMaxInliers;
    best.segment_share = 1.0;
  }
  if (hypothesis.level != TestLevel::kCoarse) {
    best.structure = best.depth_fit = 1.0;
    best.color_distance = 0.0;
  }
  best.texture = 1.0;
  best.illumination_change = 0.0;
  return confidence(best, hypothesis.hypothesis.source);
}

}  // namespace recognition
