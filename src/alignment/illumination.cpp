#include "alignment/illumination.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Dense>

#include "core/simd.h"
#include "alignment/weighted_rows.h"

namespace recognition {
namespace {

constexpr int kIterations = 4;
constexpr double kResidual =
    12.0;  // CIELAB, scale of the robust weights: what is left of texture, noise and highlights
constexpr double kFirstChroma =
    30.0;  // CIELAB a, b: what illumination alone may change at most; the first weights do not look at L
constexpr double kMaxIndependent =
    60.0;  // neighbouring pixels say the same: no more than so many count against the prior

/// Standard deviations of the prior about the identity, for (L, a, b) of the model -> one channel of the scene, and its
/// offset.
using Row = Eigen::Vector4d;
const std::array<Row, 3> kPrior = {Row(0.35, 0.10, 0.10, 18.0), Row(0.08, 0.15, 0.05, 5.0), Row(0.08, 0.05, 0.15, 5.0)};
/// Of the shading, by axis: illumination of twice or half the strength on the side that faces it is a change of 0.26.
constexpr double kShadingPrior = 0.12;
/// Gains by L, a and b, the offset, the shading; only L's row has the last.
constexpr int kUnknowns = 7, kWithoutShading = 4;
/// Colours are taken from here, so that gain and offset do not tug at each other.
const cv::Vec3f kMiddle(50.0f, 0.0f, 0.0f);

double firstWeight(const cv::Vec3f& change) {
  return robustWeight((change[1] * change[1] + change[2] * change[2]) / (kFirstChroma * kFirstChroma));
}

/// Of sums over pairs whose weights add up to `weights`, over the squared scale of the residuals.
double priorScale(double weights) {
  return std::min(1.0, kMaxIndependent / std::max(weights, 1e-9)) / (kResidual * kResidual);
}

ColorTransform weightedFit(const std::vector<ColorPair>& pairs, const std::vector<double>& weights) {
  Eigen::Matrix<double, kUnknowns, kUnknowns> normal = Eigen::Matrix<double, kUnknowns, kUnknowns>::Zero();
  Eigen::Matrix<double, kUnknowns, 3> right = Eigen::Matrix<double, kUnknowns, 3>::Zero();
  double sum = 0.0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const cv::Vec3f m = pairs[i].model - kMiddle, change = pairs[i].scene - pairs[i].model;
    Eigen::Matrix<double, kUnknowns, 1> x;
    const double root = pairs[i].model[0] + ColorTransform::kBlack;
    x << m[0], m[1], m[2], 1.0, root * pairs[i].normal.cast<double>();
    normal += weights[i] * x * x.transpose();
    right += weights[i] * x * Eigen::RowVector3d(change[0], change[1], change[2]);
    sum += weights[i];
  }
  const double scale = priorScale(sum);
  ColorTransform transform;
  for (int channel = 0; channel < 3; ++channel) {
    const int unknowns = channel == 0 ? kUnknowns : kWithoutShading;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kUnknowns, kUnknowns> system =
        scale * normal.topLeftCorner(unknowns, unknowns);
    const Row precision = kPrior[static_cast<size_t>(channel)].array().square().inverse();
    system.diagonal().head<kWithoutShading>() += precision;
    system.diagonal().tail(unknowns - kWithoutShading).array() += 1.0 / (kShadingPrior * kShadingPrior);
    const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kUnknowns, 1> x =
        system.ldlt().solve(scale * right.col(channel).head(unknowns));
    for (int i = 0; i < 3; ++i) transform.a(channel, i) += static_cast<float>(x[i]);
    transform.b[channel] = static_cast<float>(x[3] - x[0] * kMiddle[0]);
    if (channel == 0) transform.shading = x.tail<3>().cast<float>();
  }
  return transform;
}

/// Rows of the fit of lightness: change of L by gain and offset, about the middle of L.
struct LightnessRows {
  std::vector<float> model, one, change, weight;  ///< to a multiple of kRowLanes, beyond the last with weight 0

  LightnessRows(const std::vector<float>& from, const std::vector<float>& to) {
    const size_t size = (from.size() + kRowLanes - 1) / kRowLanes * kRowLanes;
    for (std::vector<float>* column : {&model, &change, &weight}) column->resize(size, 0.0f);
    one.resize(size, 1.0f);
    for (size_t i = 0; i < from.size(); ++i) {
      model[i] = from[i] - kMiddle[0];
      change[i] = to[i] - from[i];
      weight[i] = 1.0f;
    }
  }
};

RGBD_SIMD_CLONES void weighLightness(const float* model, const float* change, int count, float gain, float offset,
                                     float per_square, float* __restrict weight) {
  for (int i = 0; i < count; ++i) {
    const float residual = change[i] - (gain * model[i] + offset);
    weight[i] = robustWeight(residual * residual * per_square);
  }
}

RGBD_SIMD_CLONES void sumLightness(const LightnessRows& r, RowSums<2>& sums) {
  const float* const rows[2] = {r.model.data(), r.one.data()};
  addRows(rows, r.change.data(), r.weight.data(), static_cast<int>(r.model.size()), &sums);
}

}  // namespace

LightnessTransform fitLightness(const std::vector<float>& model, const std::vector<float>& scene) {
  if (model.empty()) return {};
  LightnessRows rows(model, scene);
  const auto per_square = static_cast<float>(1.0 / (kResidual * kResidual));
  Eigen::Vector2d x(0.0, 0.0);  // what gain and offset add to the identity
  for (int i = 0; i < kIterations; ++i) {
    if (i > 0)
      weighLightness(rows.model.data(), rows.change.data(), static_cast<int>(model.size()), static_cast<float>(x[0]),
                     static_cast<float>(x[1]), per_square, rows.weight.data());
    RowSums<2> sums;
    sumLightness(rows, sums);
    const double scale = priorScale(sums.hessian[2]);
    Eigen::Matrix2d system;
    system << sums.hessian[0], sums.hessian[1], sums.hessian[1], sums.hessian[2];
    system = scale * system;
    system(0, 0) += 1.0 / (kPrior[0][0] * kPrior[0][0]);
    system(1, 1) += 1.0 / (kPrior[0][3] * kPrior[0][3]);
    x = system.ldlt().solve(scale * Eigen::Vector2d(sums.gradient[0], sums.gradient[1]));
  }
  return {static_cast<float>(1.0 + x[0]), static_cast<float>(x[1] - x[0] * kMiddle[0])};
}

ColorTransform fitColorTransform(const std::vector<ColorPair>& pairs) {
  if (pairs.empty()) return {};
  std::vector<double> weights;
  for (const ColorPair& pair : pairs) weights.push_back(firstWeight(pair.scene - pair.model));
  ColorTransform transform = weightedFit(pairs, weights);
  for (int i = 1; i < kIterations; ++i) {
    for (size_t j = 0; j < pairs.size(); ++j) {
      const cv::Vec3f residual = pairs[j].scene - transform(pairs[j].model, pairs[j].normal);
      weights[j] = robustWeight(residual.dot(residual) / (kResidual * kResidual));
    }
    transform = weightedFit(pairs, weights);
  }
  return transform;
}

}  // namespace recognition
