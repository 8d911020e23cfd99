#include "rgbd_recognition/verification/confidence.h"

#include <algorithm>
#include <cmath>

namespace rgbd_recognition {
namespace {

constexpr double kIntercept = -11.41;
constexpr ConfidenceInputs kWeights = {3.11, 1.68, -2.24, -0.76, 1.32, 4.25, 0.83};
constexpr double kSuggestionIntercept = -12.49;
constexpr ConfidenceInputs kSuggestionWeights = {0.12, 1.60, -3.34, -1.12, 1.20, 13.13, 5.54};

double logistic(double intercept, const ConfidenceInputs& weights, const ConfidenceInputs& inputs) {
  double logit = intercept;
  for (size_t i = 0; i < inputs.size(); ++i) logit += weights[i] * inputs[i];
  return 1.0 / (1.0 + std::exp(-logit));
}

}  // namespace

ConfidenceInputs confidenceInputs(const Evidence& evidence) {
  return {std::log1p(evidence.inliers), evidence.structure, evidence.color_distance / 10.0,
          evidence.light_change / 10.0, evidence.depth_fit, evidence.segment_share, evidence.texture};
}

double confidence(const Evidence& evidence) { return logistic(kIntercept, kWeights, confidenceInputs(evidence)); }

double suggestionConfidence(const Evidence& evidence) {
  return logistic(kSuggestionIntercept, kSuggestionWeights, confidenceInputs(evidence));
}

}  // namespace rgbd_recognition
