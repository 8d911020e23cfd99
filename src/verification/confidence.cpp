#include "rgbd_recognition/verification/confidence.h"

#include <algorithm>
#include <cmath>

namespace rgbd_recognition {
namespace {

constexpr double kIntercept = -10.08;
constexpr ConfidenceInputs kWeights = {2.83, 1.80, -2.21, -0.63, 1.27, 4.06};
constexpr double kSuggestionIntercept = -8.29;
constexpr ConfidenceInputs kSuggestionWeights = {0.13, 3.74, -3.36, -0.91, 0.81, 11.75};

double logistic(double intercept, const ConfidenceInputs& weights, const ConfidenceInputs& inputs) {
  double logit = intercept;
  for (size_t i = 0; i < inputs.size(); ++i) logit += weights[i] * inputs[i];
  return 1.0 / (1.0 + std::exp(-logit));
}

}  // namespace

ConfidenceInputs confidenceInputs(const Evidence& evidence) {
  return {std::log1p(evidence.inliers), evidence.structure, evidence.color_distance / 10.0,
          evidence.light_change / 10.0, evidence.depth_fit, evidence.segment_share};
}

const std::array<const char*, 6>& confidenceInputNames() {
  static const std::array<const char*, 6> names = {"log_inliers",  "structure", "color_distance",
                                                   "light_change", "depth_fit", "segment_share"};
  return names;
}

double confidence(const Evidence& evidence) { return logistic(kIntercept, kWeights, confidenceInputs(evidence)); }

double suggestionConfidence(const Evidence& evidence) {
  return logistic(kSuggestionIntercept, kSuggestionWeights, confidenceInputs(evidence));
}

}  // namespace rgbd_recognition
