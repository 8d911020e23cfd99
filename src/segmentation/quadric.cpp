#include "segmentation/quadric.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/depth_noise.h"

namespace recognition {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kMaxSamples = 3000.0;  ///< beyond it every second, third, ... pixel is enough

/// Normal equations of the quadric; the plane's are their first three rows.
struct NormalEquations {
  Matrix6d matrix = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  double square = 0.0;
  double n = 0.0;

  /// AICc of the least-squares solution with K parameters, or infinity.
  template <int K>
  double solve(double inverse_variance, Eigen::Matrix<double, K, 1>* solution) const {
    if (n <= K + 1) return INFINITY;
    const Eigen::LDLT<Eigen::Matrix<double, K, K>> solver(matrix.template topLeftCorner<K, K>());
    if (solver.info() != Eigen::Success || solver.vectorD().minCoeff() < 1e-9 * n) return INFINITY;
    *solution = solver.solve(right.template head<K>());
    const double rss = std::max(0.0, square - solution->dot(right.template head<K>()));
    return rss * inverse_variance + 2.0 * K + 2.0 * K * (K + 1) / (n - K - 1);
  }
};

}  // namespace

bool fitQuadric(const cv::Mat& inverse, const cv::Mat& labels, int label, const cv::Rect& box,
                InverseDepthQuadric* quadric) {
  const int step = std::max(1, static_cast<int>(std::sqrt(box.area() / kMaxSamples)));
  quadric->u0 = static_cast<float>(box.x) + 0.5f * static_cast<float>(box.width - 1);
  quadric->v0 = static_cast<float>(box.y) + 0.5f * static_cast<float>(box.height - 1);
  quadric->inverse_scale = 2.0f / static_cast<float>(std::max({box.width, box.height, 2}));
  NormalEquations equations;
  double offset = 0.0;
  for (int v = box.y; v < box.br().y; v += step) {
    const int* label_row = labels.ptr<int>(v);
    const float* row = inverse.ptr<float>(v);
    const double t = (v - quadric->v0) * quadric->inverse_scale;
    for (int u = box.x; u < box.br().x; u += step) {
      if (label_row[u] != label) continue;
      if (equations.n == 0.0) offset = row[u];
      const double s = (u - quadric->u0) * quadric->inverse_scale, d = row[u] - offset;
      Vector6d basis;
      basis << 1.0, s, t, s * s, s * t, t * t;
      equations.matrix.noalias() += basis * basis.transpose();
      equations.right += d * basis;
      equations.square += d * d;
      equations.n += 1.0;
    }
  }
  const double inverse_variance = 1.0 / (depthSigma(1.0) * depthSigma(1.0));
  Vector6d full = Vector6d::Zero();
  Eigen::Vector3d flat = Eigen::Vector3d::Zero();
  const double quadric_score = equations.solve<6>(inverse_variance, &full);
  const double plane_score = equations.solve<3>(inverse_variance, &flat);
  if (std::isinf(quadric_score) && std::isinf(plane_score)) return false;
  if (plane_score <= quadric_score) full << flat, Eigen::Vector3d::Zero();
  full[0] += offset;
  for (int i = 0; i < 6; ++i) quadric->q[static_cast<size_t>(i)] = static_cast<float>(full[i]);
  return true;
}

}  // namespace recognition
