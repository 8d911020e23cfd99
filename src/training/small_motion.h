#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// Normal equations of a small motion about `centre`, from points that shall move onto a surface.
struct SmallMotion {
  static constexpr double kRobustSigma = 0.002;  // metres; pairs much farther apart count little
  static constexpr double kPairSigma = 0.0003;  // metres, of all pairs together: what they agree on is not better known
  static constexpr double kLeverArm = 0.2;      // metres at which a turn counts as a shift

  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  double pairs = 0.0;  ///< their weight

  /// Point-to-plane: p shall move onto the plane of `target`. Returns its distance from it, metres.
  double addPair(const Eigen::Vector3d& p, const SurfacePoint& target) {
    const Eigen::Vector3d m = target.normal.cast<double>();
    const double residual = m.dot(target.position.cast<double>() - p);
    const double robust = 1.0 / (1.0 + residual * residual / (kRobustSigma * kRobustSigma));
    Eigen::Matrix<double, 6, 1> j;
    j << m, (p - centre).cross(m);
    a += robust * j * j.transpose();
    b += robust * j * residual;
    pairs += robust;
    return std::abs(residual);
  }

  /// Back to where `drift` leads, as far as pose_sigma asks, metres; as an angle at 0.2 m.
  void addPrior(const Pose& drift, double pose_sigma) {
    const double trust = pairs * kPairSigma * kPairSigma / (pose_sigma * pose_sigma);
    const double turn_trust = trust * kLeverArm * kLeverArm;
    const Eigen::AngleAxisd turn(drift.linear());
    a.topLeftCorner<3, 3>() += trust * Eigen::Matrix3d::Identity();
    a.bottomRightCorner<3, 3>() += turn_trust * Eigen::Matrix3d::Identity();
    b.head<3>() += trust * (drift * centre - centre);
    b.tail<3>() += turn_trust * turn.angle() * turn.axis();
  }

  /// The motion that the pairs hold least, of one metre, a turn of a radian as `lever` metres. Nothing if there is none
  /// that they hold by less than `share` of how they hold any other.
  std::optional<Eigen::Matrix<double, 6, 1>> freeMotion(double lever, double share) const {
    Eigen::Matrix<double, 6, 1> unit;
    unit << 1.0, 1.0, 1.0, 1.0 / lever, 1.0 / lever, 1.0 / lever;
    const Eigen::Matrix<double, 6, 6> scaled = unit.asDiagonal() * a * unit.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> holds(scaled);
    if (!scaled.allFinite() || holds.eigenvalues()[0] > share * holds.eigenvalues()[1]) return std::nullopt;
    return unit.cwiseProduct(holds.eigenvectors().col(0));
  }

  Pose solve() const { return motionBy(a.ldlt().solve(b)); }

  /// x: a shift, metres, and a turn about the centre, radians; none where it is not finite.
  Pose motionBy(const Eigen::Matrix<double, 6, 1>& x) const {
    Pose motion = Pose::Identity();
    if (!x.allFinite()) return motion;
    const double angle = x.tail<3>().norm();
    if (angle > 1e-12) motion.linear() = Eigen::AngleAxisd(angle, x.tail<3>() / angle).toRotationMatrix();
    motion.translation() = centre + x.head<3>() - motion.linear() * centre;
    return motion;
  }
};

}  // namespace recognition
