#include "rgbd_recognition/matching/rigid_transform.h"

#include <stdexcept>
#include <string>

#include <Eigen/SVD>

namespace rgbd_recognition {
namespace {

Eigen::Vector3d mean(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

}  // namespace

std::optional<Pose> rigidTransform(const std::vector<Eigen::Vector3d>& source,
                                   const std::vector<Eigen::Vector3d>& target, double min_spread) {
  if (source.size() != target.size())
    throw std::invalid_argument("rigid transform of " + std::to_string(source.size()) + " to " +
                                std::to_string(target.size()) + " points");
  if (source.size() < 3) return std::nullopt;

  const Eigen::Vector3d source_mean = mean(source), target_mean = mean(target);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < source.size(); ++i)
    covariance += (target[i] - target_mean) * (source[i] - source_mean).transpose();
  covariance /= static_cast<double>(source.size());

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > min_spread * min_spread)) return std::nullopt;
  Eigen::Matrix3d u = svd.matrixU();
  if (u.determinant() * svd.matrixV().determinant() < 0.0) u.col(2) = -u.col(2);

  Pose pose = Pose::Identity();
  pose.linear() = u * svd.matrixV().transpose();
  pose.translation() = target_mean - pose.linear() * source_mean;
  return pose;
}

}  // namespace rgbd_recognition
