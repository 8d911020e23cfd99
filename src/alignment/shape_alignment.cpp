#include "alignment/shape_alignment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

#include <Eigen/Eigenvalues>

#include "core/angles.h"

namespace recognition {
namespace {

constexpr int kRotations = 24;            // rotations tried about an axis
constexpr double kSizeTolerance = 0.08;   // of each extent, between models that may be taken for one another
constexpr int kSurfacePoints = 300;       // points that must land on the surface again
constexpr double kMinOnSurface = 0.9;     // share of them
constexpr double kToleranceShare = 0.02;  // of the object's length: what counts as on the surface

/// Set of the voxels near a surface.
class SurfaceVoxels {
 public:
  SurfaceVoxels(const std::vector<Eigen::Vector3f>& positions, double size) : size_(size) {
    for (const Eigen::Vector3f& p : positions) {
      const Eigen::Vector3i cell = cellOf(p.cast<double>());
      for (int i = 0; i < 27; ++i) cells_.insert(key(cell + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
    }
  }
  bool near(const Eigen::Vector3d& p) const { return cells_.count(key(cellOf(p))) > 0; }

 private:
  Eigen::Vector3i cellOf(const Eigen::Vector3d& p) const { return (p / size_).array().floor().cast<int>(); }
  static std::int64_t key(const Eigen::Vector3i& c) {
    return (static_cast<std::int64_t>(c.x() + (1 << 19)) << 40) | (static_cast<std::int64_t>(c.y() + (1 << 19)) << 20) |
           static_cast<std::int64_t>(c.z() + (1 << 19));
  }

  double size_;
  std::unordered_set<std::int64_t> cells_;
};

/// Turns about each axis, and the half turns across the long one combined with turns about it.
std::vector<Eigen::Matrix3d> candidateRotations() {
  std::vector<Eigen::Matrix3d> rotations = {Eigen::Matrix3d::Identity()};
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 1; i < kRotations; ++i)
      rotations.push_back(
          Eigen::AngleAxisd(2.0 * kPi * i / kRotations, Eigen::Vector3d::Unit(axis)).toRotationMatrix());
  for (int axis : {0, 2}) {
    const Eigen::Matrix3d flip = Eigen::AngleAxisd(kPi, Eigen::Vector3d::Unit(1)).toRotationMatrix();
    for (int i = 1; i < kRotations; ++i) {
      if (2 * i == kRotations) continue;  // a half turn about the third axis, listed above
      rotations.push_back(Eigen::AngleAxisd(2.0 * kPi * i / kRotations, Eigen::Vector3d::Unit(axis)) * flip);
    }
  }
  return rotations;
}

bool sameSize(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return ((a - b).cwiseAbs().array() <= kSizeTolerance * a.cwiseMax(b).array()).all();
}

}  // namespace

PrincipalShape principalShape(const std::vector<Eigen::Vector3f>& positions) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : positions) mean += p.cast<double>();
  mean /= static_cast<double>(positions.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& p : positions) {
    const Eigen::Vector3d d = p.cast<double>() - mean;
    covariance += d * d.transpose();
  }
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  for (const auto& p : positions) {
    const Eigen::Vector3d q = axes.transpose() * p.cast<double>();
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  PrincipalShape shape;
  shape.size = high - low;
  shape.object_from_principal.linear() = axes;
  shape.object_from_principal.translation() = axes * (0.5 * (low + high));
  return shape;
}

std::vector<Pose> alignShapes(const PreparedModel& fixed, const PreparedModel& moving) {
  if (!sameSize(fixed.shape.size, moving.shape.size)) return {};
  const double spacing = fixed.point_radius;
  const SurfaceVoxels surface(fixed.positions, std::max(kToleranceShare * fixed.shape.size.maxCoeff(), 1.5 * spacing));
  const size_t step = std::max<size_t>(1, moving.positions.size() / kSurfacePoints);
  std::vector<Pose> alignments;
  for (const Eigen::Matrix3d& rotation : candidateRotations()) {
    const Pose fixed_from_moving =
        fixed.shape.object_from_principal * rotation * moving.shape.object_from_principal.inverse();
    int on_surface = 0, samples = 0;
    for (size_t i = 0; i < moving.positions.size(); i += step, ++samples)
      on_surface += surface.near(fixed_from_moving * moving.positions[i].cast<double>());
    if (on_surface >= kMinOnSurface * samples) alignments.push_back(fixed_from_moving);
  }
  return alignments;
}

}  // namespace recognition
