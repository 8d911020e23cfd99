#include "rgbd_recognition/verification/confidence.h"

#include <algorithm>
#include <cmath>

namespace rgbd_recognition {
namespace {

constexpr double kIntercept = -10.08;
constexpr ConfidenceInputs kWeights = {2.83, 1.80, -2.21, -0.63, 1.27, 4.06};

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

double confidence(const Evidence& evidence) {
  const ConfidenceInputs inputs = confidenceInputs(evidence);
  double logit = kIntercept;
  for (size_t i = 0; i < inputs.size(); ++i) logit += kWeights[i] * inputs[i];
  return 1.0 / (1.0 + std::exp(-logit));
}

}  // namespace rgbd_recognition
