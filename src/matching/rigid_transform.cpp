#include "matching/rigid_transform.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/SVD>

namespace recognition {
namespace {

Eigen::Vector3d mean(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

void requireAsMany(size_t a, size_t b) {
  if (a != b)
    throw std::invalid_argument("rigid transform of " + std::to_string(a) + " to " + std::to_string(b) + " points");
}

Eigen::Matrix3d covariance(const std::vector<Eigen::Vector3d>& source, const Eigen::Vector3d& source_mean,
                           const std::vector<Eigen::Vector3d>& target, const Eigen::Vector3d& target_mean) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < source.size(); ++i) sum += (target[i] - target_mean) * (source[i] - source_mean).transpose();
  return sum / static_cast<double>(source.size());
}

std::optional<Pose> solve(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& source_mean,
                          const Eigen::Vector3d& target_mean, double min_spread) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > min_spread * min_spread)) return std::nullopt;
  Eigen::Matrix3d u = svd.matrixU();
  if (u.determinant() * svd.matrixV().determinant() < 0.0) u.col(2) = -u.col(2);

  Pose pose = Pose::Identity();
  pose.linear() = u * svd.matrixV().transpose();
  pose.translation() = target_mean - pose.linear() * source_mean;
  return pose;
}

/// A triangle's plane, and its corners in that plane from their mean on.
struct PlanarTriangle {
  Eigen::Vector3f mean;
  Eigen::Matrix3f axes;  // two in the plane and the normal
  Eigen::Matrix<float, 2, 3> corners;

  /// False for points on a line.
  bool set(const Triangle& triangle) {
    const Eigen::Vector3f a = triangle[1] - triangle[0], b = triangle[2] - triangle[0], normal = a.cross(b);
    if (!(normal.squaredNorm() > 0.0f)) return false;
    mean = triangle[0] + (a + b) / 3.0f;
    axes.col(0) = a.normalized();
    axes.col(2) = normal.normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    for (int i = 0; i < 3; ++i) corners.col(i) = axes.leftCols<2>().transpose() * (triangle[i] - mean);
    return true;
  }
};

}  // namespace

std::optional<Pose> rigidTransform(const std::vector<Eigen::Vector3d>& source,
                                   const std::vector<Eigen::Vector3d>& target, double min_spread) {
  requireAsMany(source.size(), target.size());
  if (source.size() < 3) return std::nullopt;
  const Eigen::Vector3d source_mean = mean(source), target_mean = mean(target);
  return solve(covariance(source, source_mean, target, target_mean), source_mean, target_mean, min_spread);
}

std::optional<Pose> rigidTransform(const std::vector<Eigen::Vector3d>& source,
                                   const std::vector<Eigen::Vector3d>& target,
                                   const std::vector<Eigen::Quaternionf>& rotations, double lever) {
  requireAsMany(source.size(), target.size());
  requireAsMany(source.size(), rotations.size());
  if (source.empty()) return std::nullopt;
  const Eigen::Vector3d source_mean = mean(source), target_mean = mean(target);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Quaternionf& rotation : rotations) sum += rotation.cast<double>().toRotationMatrix();
  const Eigen::Matrix3d proposed = lever * lever / static_cast<double>(rotations.size()) * sum;
  return solve(covariance(source, source_mean, target, target_mean) + proposed, source_mean, target_mean, 0.0);
}

std::optional<Pose> triangleTransform(const Triangle& source, const Triangle& target, double min_spread) {
  PlanarTriangle s, t;
  if (!s.set(source) || !t.set(target)) return std::nullopt;
  const Eigen::Matrix2f h = t.corners * s.corners.transpose() / 3.0f;  // its determinant is positive
  const float cosine = h(0, 0) + h(1, 1), sine = h(1, 0) - h(0, 1);
  const float sum = Eigen::Vector2f(cosine, sine).norm();  // of the two singular values
  const float difference = Eigen::Vector2f(h(0, 0) - h(1, 1), h(1, 0) + h(0, 1)).norm();
  if (!(0.5f * (sum - difference) > static_cast<float>(min_spread * min_spread))) return std::nullopt;

  Eigen::Matrix3f turned = t.axes;
  turned.col(0) = (cosine * t.axes.col(0) + sine * t.axes.col(1)) / sum;
  turned.col(1) = turned.col(2).cross(turned.col(0));
  Pose pose = Pose::Identity();
  pose.linear() = (turned * s.axes.transpose()).cast<double>();
  pose.translation() = (t.mean - turned * (s.axes.transpose() * s.mean)).cast<double>();
  return pose;
}

Pose meanTransform(const Triangle& source, const Triangle& target, const std::array<Eigen::Quaternionf, 3>& rotations) {
  Eigen::Vector4f sum = rotations[0].coeffs();
  for (int i = 1; i < 3; ++i)
    sum += rotations[i].dot(rotations[0]) < 0.0f ? Eigen::Vector4f(-rotations[i].coeffs()) : rotations[i].coeffs();
  const Eigen::Matrix3f rotation = Eigen::Quaternionf(sum).normalized().toRotationMatrix();
  const Eigen::Vector3f place =
      (target[0] + target[1] + target[2] - rotation * (source[0] + source[1] + source[2])) / 3.0f;
  Pose pose = Pose::Identity();
  pose.linear() = rotation.cast<double>();
  pose.translation() = place.cast<double>();
  return pose;
}

}  // namespace recognition
