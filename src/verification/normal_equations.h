#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "rgbd_recognition/verification/pose_refiner.h"

namespace rgbd_recognition {

inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Weighted least squares over six unknowns: translation and rotation (about an anchor point), camera axes.
class NormalEquations {
 public:
  /// A residual already divided by its standard deviation, its derivative by the point p in the camera frame, and the
  /// arm p - anchor.
  void add(double residual, const Eigen::Vector3d& by_point, const Eigen::Vector3d& arm, double weight) {
    Vector6d row;
    row << by_point, arm.cross(by_point);
    hessian_.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
    gradient_ += weight * residual * row;
    squares_ += weight * residual * residual;
    weights_ += weight;
  }

  Matrix6d hessian() const { return hessian_.selfadjointView<Eigen::Lower>(); }
  /// The step that the residuals ask for; `prior`: inverse variances that hold directions nothing else holds.
  Vector6d step(const Vector6d& prior) const {
    Matrix6d system = hessian();
    system.diagonal() += prior;
    return system.ldlt().solve(-gradient_);
  }
  /// Weighted mean square of the residuals: 1 if the noise is as assumed.
  double chiSquare() const { return weights_ > 0.0 ? squares_ / weights_ : 0.0; }
  double weights() const { return weights_; }

 private:
  Matrix6d hessian_ = Matrix6d::Zero();
  Vector6d gradient_ = Vector6d::Zero();
  double squares_ = 0.0;
  double weights_ = 0.0;
};

}  // namespace rgbd_recognition
