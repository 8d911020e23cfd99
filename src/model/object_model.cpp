#include "rgbd_recognition/model/object_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Eigenvalues>

namespace recognition {

Extents computeExtents(const std::vector<SurfacePoint>& cloud) {
  if (cloud.size() < 4)
    throw std::invalid_argument("extents need at least 4 points, got " + std::to_string(cloud.size()));
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const SurfacePoint& point : cloud) mean += point.position.cast<double>();
  mean /= static_cast<double>(cloud.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const SurfacePoint& point : cloud) {
    const Eigen::Vector3d d = point.position.cast<double>() - mean;
    covariance += d * d.transpose();
  }
  covariance /= static_cast<double>(cloud.size());
  const Eigen::Vector3d lambda =  // min, med, max
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().cwiseMax(0.0);
  Extents extents;
  extents.sigma_min = 2.0 * 3.0 * std::sqrt(lambda[0]);            // eq. (4a)
  extents.sigma_max = 2.0 * 3.0 * std::sqrt(lambda[2]);            // eq. (4a)
  extents.sigma_d = 0.5 * 6.0 * std::sqrt(lambda[1] + lambda[0]);  // eq. (4b)
  return extents;
}

ModelFeatures moved(ModelFeatures features, const Pose& to_from) {
  const Eigen::Isometry3f pose(to_from.cast<float>());
  for (Eigen::Vector3f& position : features.positions) position = pose * position;
  for (auto* directions : {&features.view_directions, &features.orientations})
    for (Eigen::Vector3f& direction : *directions) direction = pose.linear() * direction;
  return features;
}

ObjectModel moved(ObjectModel model, const Pose& to_from) {
  const Eigen::Isometry3f pose(to_from.cast<float>());
  for (SurfacePoint& point : model.cloud) {
    point.position = pose * point.position;
    point.normal = pose.linear() * point.normal;
  }
  for (RestPlane& plane : model.rest_planes) {
    plane.normal = pose.linear() * plane.normal;
    plane.offset += plane.normal.dot(pose.translation());
  }
  for (auto& [type, features] : model.features) features = moved(std::move(features), to_from);
  return model;
}

int ModelDatabase::find(const std::string& name) const {
  for (size_t i = 0; i < objects.size(); ++i)
    if (objects[i]->name == name) return static_cast<int>(i);
  return -1;
}

Extents extentLimits(const ModelDatabase& database) {
  Extents limits;
  for (const auto& object : database.objects) {
    const bool first = object == database.objects.front();
    limits.sigma_min = first ? object->extents.sigma_min : std::min(limits.sigma_min, object->extents.sigma_min);
    limits.sigma_max = std::max(limits.sigma_max, object->extents.sigma_max);
    limits.sigma_d = std::max(limits.sigma_d, object->extents.sigma_d);
  }
  return limits;
}

}  // namespace recognition
