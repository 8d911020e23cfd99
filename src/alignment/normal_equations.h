#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "alignment/alignment_kernels.h"
#include "alignment/pose_refiner.h"

namespace recognition {

inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Translation and rotation about an anchor point (camera axes), and the image's magnification round the anchor.
using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// Weighted least squares over these unknowns.
class NormalEquations {
 public:
  /// A residual already divided by its standard deviation, its derivatives by the point p in the camera frame and by
  /// the magnification, and the arm p - anchor.
  void add(double residual, const Eigen::Vector3d& by_point, double by_magnification, const Eigen::Vector3d& arm,
           double weight) {
    Vector7d row;
    row << by_point, arm.cross(by_point), by_magnification;
    hessian_.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
    gradient_ += weight * residual * row;
    squares_ += weight * residual * residual;
    weights_ += weight;
  }

  /// Rows that are summed up already, each counting `share` of one.
  void add(const AlignmentRows& rows, double share) {
    const AlignmentSums sums = rows.sum();
    for (int a = 0, k = 0; a < kAlignmentParameters; ++a) {
      for (int b = 0; b <= a; ++b, ++k) hessian_(a, b) += share * sums.hessian[k];
      gradient_[a] += share * sums.gradient[a];
    }
    squares_ += share * rows.squares();
    weights_ += share * rows.weights();
  }

  Matrix7d hessian() const { return hessian_.selfadjointView<Eigen::Lower>(); }
  const Vector7d& gradient() const { return gradient_; }
  /// Weighted mean square of the residuals: 1 if the noise is as assumed.
  double chiSquare() const { return weights_ > 0.0 ? squares_ / weights_ : 0.0; }

 private:
  Matrix7d hessian_ = Matrix7d::Zero();
  Vector7d gradient_ = Vector7d::Zero();
  double squares_ = 0.0;
  double weights_ = 0.0;
};

}  // namespace recognition
