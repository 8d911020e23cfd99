#include "segmentation/polynomial_fit.h"

#include <algorithm>
#include <limits>

#include "core/simd.h"

namespace recognition {
namespace {

#define RGBD_ALWAYS_INLINE inline __attribute__((always_inline))

/// Eq. (6)-(7) for a model with k parameters and no residuals.
double aiccPenalty(int k, int n) {
  if (n <= k + 1) return std::numeric_limits<double>::infinity();
  return 2.0 * k + 2.0 * k * (k + 1) / (n - k - 1);
}

/// Fit from sums over the run, x counted from anywhere; `centre` is the middle of the run in x, the rest are FitTables'
/// values for its length.
RGBD_ALWAYS_INLINE LeastSquaresFit fitSums(double z, double xz, double xxz, double zz, double centre, double inverse_n,
                                           double mean_t2, double inverse_t2, double inverse_p2) {
  const double tz = xz - centre * z;
  const double pz = xxz - centre * (xz + tz) - mean_t2 * z;  // sum of (t^2 - s) z
  LeastSquaresFit fit;
  fit.mean = z * inverse_n;
  fit.slope = tz * inverse_t2;
  fit.curvature = pz * inverse_p2;
  const double linear = zz - fit.mean * z - fit.slope * tz;
  const double quadratic = linear - fit.curvature * pz;
  fit.rss_linear = linear > 0.0 ? linear : 0.0;
  fit.rss_quadratic = quadratic > 0.0 ? quadratic : 0.0;
  return fit;
}

struct SumPointers {
  const double *z, *xz, *xxz, *zz;
};

struct TablePointers {
  const double *middle, *inverse_n, *mean_t2, *inverse_t2, *inverse_p2, *penalty_linear, *penalty_quadratic;
};

/// One run's table values.
struct TableRow {
  double inverse_n, mean_t2, inverse_t2, inverse_p2, penalty_linear, penalty_quadratic;
};

RGBD_ALWAYS_INLINE TableRow rowAt(const TablePointers& t, int n) {
  return {t.inverse_n[n], t.mean_t2[n], t.inverse_t2[n], t.inverse_p2[n], t.penalty_linear[n], t.penalty_quadratic[n]};
}

RGBD_ALWAYS_INLINE double scoreSums(double z, double xz, double xxz, double zz, double centre, const TableRow& t,
                                    double inverse_variance) {
  const LeastSquaresFit fit = fitSums(z, xz, xxz, zz, centre, t.inverse_n, t.mean_t2, t.inverse_t2, t.inverse_p2);
  const double linear = fit.rss_linear * inverse_variance + t.penalty_linear;
  const double quadratic = fit.rss_quadratic * inverse_variance + t.penalty_quadratic;
  return quadratic < linear ? quadratic : linear;
}

/// RunSums::splitScores for a run of n samples that begins at x = `begin`.
RGBD_SIMD_CLONES void scoreLoop(SumPointers sums, double begin, int n, TablePointers tables, double inverse_variance,
                                double* __restrict scores) {
  const SumPointers s = sums;
  const TablePointers t = tables;
  const double z0 = s.z[0], xz0 = s.xz[0], xxz0 = s.xxz[0], zz0 = s.zz[0];
  const double zn = s.z[n], xzn = s.xz[n], xxzn = s.xxz[n], zzn = s.zz[n];
  const double last = begin + (n - 1);
  const int end = n - kShortestAicc;
  for (int k = kShortestAicc; k <= end; ++k) {
    const double left = scoreSums(s.z[k] - z0, s.xz[k] - xz0, s.xxz[k] - xxz0, s.zz[k] - zz0, begin + t.middle[k],
                                  rowAt(t, k), inverse_variance);
    const double right = scoreSums(zn - s.z[k], xzn - s.xz[k], xxzn - s.xxz[k], zzn - s.zz[k], last - t.middle[n - k],
                                   rowAt(t, n - k), inverse_variance);
    scores[k] = left + right;
  }
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
  for (int i = static_cast<int>(inverse_n.size()); i <= n; ++i) {
    const double m = i, square = m * m;
    middle.push_back(0.5 * (m - 1.0));
    inverse_n.push_back(i >= 1 ? 1.0 / m : 0.0);
    mean_t2.push_back((square - 1.0) / 12.0);
    inverse_t2.push_back(i >= 2 ? 12.0 / (m * (square - 1.0)) : 0.0);
    inverse_p2.push_back(i >= 3 ? 180.0 / (m * (square - 1.0) * (square - 4.0)) : 0.0);
    penalty_linear.push_back(aiccPenalty(2, i));
    penalty_quadratic.push_back(aiccPenalty(3, i));
  }
}

void RunSums::build(const float* z, int first, int last) {
  const size_t n = static_cast<size_t>(last - first + 1);
  if (z_.size() < n + 1)
    for (std::vector<double>* sums : {&z_, &xz_, &xxz_, &zz_}) sums->resize(n + 1);
  first_ = first;
  offset_ = z[first];
  double sum_z = 0.0, sum_xz = 0.0, sum_xxz = 0.0, sum_zz = 0.0;
  for (size_t i = 0; i < n; ++i) {
    const double value = z[first + static_cast<int>(i)] - offset_;
    const double x_value = static_cast<double>(i) * value;
    z_[i + 1] = sum_z += value;
    xz_[i + 1] = sum_xz += x_value;
    xxz_[i + 1] = sum_xxz += static_cast<double>(i) * x_value;
    zz_[i + 1] = sum_zz += value * value;
  }
}

LeastSquaresFit RunSums::fit(int first, int last, const FitTables& tables) const {
  const size_t a = static_cast<size_t>(first - first_), b = static_cast<size_t>(last - first_ + 1), n = b - a;
  const double centre = 0.5 * (first + last) - first_;
  return fitSums(z_[b] - z_[a], xz_[b] - xz_[a], xxz_[b] - xxz_[a], zz_[b] - zz_[a], centre, tables.inverse_n[n],
                 tables.mean_t2[n], tables.inverse_t2[n], tables.inverse_p2[n]);
}

Polynomial RunSums::linear(const LeastSquaresFit& fit, int first, int last) const {
  return {fit.mean + offset_, fit.slope, 0.0, 0.5 * (first + last)};
}

Polynomial RunSums::quadratic(const LeastSquaresFit& fit, int first, int last, const FitTables& tables) const {
  const double s = tables.mean_t2[static_cast<size_t>(last - first + 1)];
  return {fit.mean + offset_ - s * fit.curvature, fit.slope, fit.curvature, 0.5 * (first + last)};
}

void RunSums::splitScores(int first, int last, const FitTables& tables, double inverse_variance, double* scores) const {
  const size_t a = static_cast<size_t>(first - first_);
  scoreLoop({z_.data() + a, xz_.data() + a, xxz_.data() + a, zz_.data() + a}, static_cast<double>(a), last - first + 1,
            {tables.middle.data(), tables.inverse_n.data(), tables.mean_t2.data(), tables.inverse_t2.data(),
             tables.inverse_p2.data(), tables.penalty_linear.data(), tables.penalty_quadratic.data()},
            inverse_variance, scores);
}

AdaptiveScore adaptiveScore(const LeastSquaresFit& fit, int n, const FitTables& tables, double inverse_variance) {
  const double linear = fit.rss_linear * inverse_variance + tables.penalty_linear[static_cast<size_t>(n)];
  const double quadratic = fit.rss_quadratic * inverse_variance + tables.penalty_quadratic[static_cast<size_t>(n)];
  return {std::min(linear, quadratic), quadratic < linear};
}

}  // namespace recognition
