#include "rgbd_recognition/verification/color_transform.h"

#include <array>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Dense>

namespace rgbd_recognition {
namespace {

constexpr int kIterations = 4;
constexpr double kResidual =
    12.0;  // CIELAB, scale of the robust weights: what is left of texture, noise and highlights
constexpr double kFirstChroma =
    30.0;  // CIELAB a, b: what light alone may change at most; the first weights do not look at L
constexpr double kMaxIndependent =
    60.0;  // neighbouring pixels say the same: no more than so many count against the prior

/// Standard deviations of the prior about the identity, for (L, a, b) of the model -> one channel of the scene, and its
/// offset.
using Row = Eigen::Vector4d;
const std::array<Row, 3> kPrior = {Row(0.35, 0.10, 0.10, 18.0), Row(0.08, 0.15, 0.05, 5.0), Row(0.08, 0.05, 0.15, 5.0)};
/// Colours are taken from here, so that gain and offset do not tug at each other.
const cv::Vec3f kMiddle(50.0f, 0.0f, 0.0f);

double robustWeight(double scaled_square) {
  return 1.0 / ((1.0 + scaled_square) * (1.0 + scaled_square));
}  // Geman-McClure

double firstWeight(const cv::Vec3f& change) {
  return robustWeight((change[1] * change[1] + change[2] * change[2]) / (kFirstChroma * kFirstChroma));
}

ColorTransform weightedFit(const std::vector<ColorPair>& pairs, const std::vector<double>& weights) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
  double sum = 0.0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const cv::Vec3f m = pairs[i].model - kMiddle, change = pairs[i].scene - pairs[i].model;
    const Eigen::Vector4d x(m[0], m[1], m[2], 1.0);
    normal += weights[i] * x * x.transpose();
    right += weights[i] * x * Eigen::RowVector3d(change[0], change[1], change[2]);
    sum += weights[i];
  }
  const double scale = std::min(1.0, kMaxIndependent / std::max(sum, 1e-9)) / (kResidual * kResidual);
  ColorTransform transform;
  for (int channel = 0; channel < 3; ++channel) {
    const Eigen::Vector4d precision = kPrior[static_cast<size_t>(channel)].array().square().inverse();
    const Eigen::Matrix4d system = scale * normal + Eigen::Matrix4d(precision.asDiagonal());
    const Eigen::Vector4d x = system.ldlt().solve(scale * right.col(channel));
    for (int i = 0; i < 3; ++i) transform.a(channel, i) += static_cast<float>(x[i]);
    transform.b[channel] = static_cast<float>(x[3] - x[0] * kMiddle[0]);
  }
  return transform;
}

}  // namespace

ColorTransform fitColorTransform(const std::vector<ColorPair>& pairs) {
  if (pairs.empty()) return {};
  std::vector<double> weights;
  for (const ColorPair& pair : pairs) weights.push_back(firstWeight(pair.scene - pair.model));
  ColorTransform transform = weightedFit(pairs, weights);
  for (int i = 1; i < kIterations; ++i) {
    for (size_t j = 0; j < pairs.size(); ++j) {
      const cv::Vec3f residual = pairs[j].scene - transform(pairs[j].model);
      weights[j] = robustWeight(residual.dot(residual) / (kResidual * kResidual));
    }
    transform = weightedFit(pairs, weights);
  }
  return transform;
}

}  // namespace rgbd_recognition
