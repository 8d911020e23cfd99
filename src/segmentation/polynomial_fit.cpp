#include "rgbd_recognition/segmentation/polynomial_fit.h"

#include <algorithm>
#include <limits>

namespace rgbd_recognition {
namespace {

/// Eq. (6)-(7) for a model with k parameters and no residuals.
double aiccPenalty(int k, int n) {
  if (n <= k + 1) return std::numeric_limits<double>::infinity();
  return 2.0 * k + 2.0 * k * (k + 1) / (n - k - 1);
}

}  // namespace

Polynomial fitSimpleLinear(const float* z, int first, int last) {
  const double slope = (static_cast<double>(z[last]) - z[first]) / (last - first);
  return {z[first], slope, 0.0, static_cast<double>(first)};
}

Polynomial fitSimpleQuadratic(const float* z, int first, int last) {
  const int middle = (first + last) / 2;
  const double a = first - middle, b = last - middle;
  const double slope_a = (static_cast<double>(z[first]) - z[middle]) / a;
  const double slope_b = (static_cast<double>(z[last]) - z[middle]) / b;
  const double c2 = (slope_b - slope_a) / (b - a);
  return {z[middle], slope_a - c2 * a, c2, static_cast<double>(middle)};
}

void FitTables::reserve(int n) {
  for (int i = static_cast<int>(entries_.size()); i <= n; ++i) {
    const double m = i, square = m * m;
    Entry entry;
    entry.mean_t2 = (square - 1.0) / 12.0;
    if (i >= 1) entry.inverse_n = 1.0 / m;
    if (i >= 2) entry.inverse_t2 = 12.0 / (m * (square - 1.0));
    if (i >= 3) entry.inverse_p2 = 180.0 / (m * (square - 1.0) * (square - 4.0));
    entry.penalty_linear = aiccPenalty(2, i);
    entry.penalty_quadratic = aiccPenalty(3, i);
    entries_.push_back(entry);
  }
}

void RunSums::build(const float* z, int first, int last) {
  const size_t n = static_cast<size_t>(last - first + 1);
  if (prefix_.size() < n + 1) prefix_.resize(n + 1);
  first_ = first;
  offset_ = z[first];
  Sums sums{0.0, 0.0, 0.0, 0.0};
  prefix_[0] = sums;
  for (size_t i = 0; i < n; ++i) {
    const double value = z[first + static_cast<int>(i)] - offset_;
    const double x = static_cast<double>(i);
    sums.z += value;
    sums.xz += x * value;
    sums.xxz += x * x * value;
    sums.zz += value * value;
    prefix_[i + 1] = sums;
  }
}

RunSums::Fit RunSums::fit(int first, int last, const FitTables& tables) const {
  const Sums& a = prefix_[static_cast<size_t>(first - first_)];
  const Sums& b = prefix_[static_cast<size_t>(last - first_ + 1)];
  const FitTables::Entry& entry = tables[last - first + 1];
  const double centre = 0.5 * (first + last) - first_;
  const double z = b.z - a.z, xz = b.xz - a.xz, xxz = b.xxz - a.xxz, zz = b.zz - a.zz;
  const double tz = xz - centre * z;
  const double pz = xxz - centre * (xz + tz) - entry.mean_t2 * z;  // sum of (t^2 - s) z
  Fit fit;
  fit.mean = z * entry.inverse_n;
  fit.slope = tz * entry.inverse_t2;
  fit.curvature = pz * entry.inverse_p2;
  fit.rss_linear = std::max(0.0, zz - fit.mean * z - fit.slope * tz);
  fit.rss_quadratic = std::max(0.0, fit.rss_linear - fit.curvature * pz);
  return fit;
}

Polynomial RunSums::linear(const Fit& fit, int first, int last) const {
  return {fit.mean + offset_, fit.slope, 0.0, 0.5 * (first + last)};
}

Polynomial RunSums::quadratic(const Fit& fit, int first, int last, const FitTables& tables) const {
  const double s = tables[last - first + 1].mean_t2;
  return {fit.mean + offset_ - s * fit.curvature, fit.slope, fit.curvature, 0.5 * (first + last)};
}

AdaptiveScore adaptiveScore(const RunSums::Fit& fit, const FitTables::Entry& entry, double inverse_variance) {
  const double linear = fit.rss_linear * inverse_variance + entry.penalty_linear;
  const double quadratic = fit.rss_quadratic * inverse_variance + entry.penalty_quadratic;
  return {std::min(linear, quadratic), quadratic < linear};
}

}  // namespace rgbd_recognition
