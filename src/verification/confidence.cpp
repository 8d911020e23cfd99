#include "rgbd_recognition/verification/confidence.h"

#include <algorithm>
#include <cmath>

namespace rgbd_recognition {
namespace {

constexpr double kIntercept = -13.0;
constexpr ConfidenceInputs kWeights = {2.2, 3.0, 4.0, 0.0, -1.5, -0.5, 5.0, 1.0, 0.5};

}  // namespace

ConfidenceInputs confidenceInputs(const ConsistencyScores& scores, const Evidence& evidence) {
  return {std::log1p(evidence.inliers),
          evidence.structure,
          evidence.structure * evidence.texture,
          evidence.texture,
          evidence.color_distance / 10.0,
          evidence.light_change / 10.0,
          evidence.depth_fit,
          scores.visible,
          std::log10(1.0 + evidence.seen)};
}

const std::array<const char*, 9>& confidenceInputNames() {
  static const std::array<const char*, 9> names = {"log_inliers", "structure",      "structure_texture",
                                                   "texture",     "color_distance", "light_change",
                                                   "depth_fit",   "visible",        "log_seen"};
  return names;
}

double confidence(const ConsistencyScores& scores, const Evidence& evidence) {
  const ConfidenceInputs inputs = confidenceInputs(scores, evidence);
  double logit = kIntercept;
  for (size_t i = 0; i < inputs.size(); ++i) logit += kWeights[i] * inputs[i];
  return 1.0 / (1.0 + std::exp(-logit));
}

}  // namespace rgbd_recognition
