#include "alignment/prepared_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "matching/geometric_consistency.h"
#include "alignment/shape_alignment.h"

namespace recognition {
namespace {

constexpr int kSpacingSamples = 200;
constexpr int kSpacingNeighbours = 3;
constexpr double kSpacingQuantile = 0.9;
constexpr double kSameRotation = 0.1;  // radians
constexpr int kProbePoints = 800;
constexpr size_t kCoarseStep = 4;
constexpr double kFaceAngle = 30.0, kHalfAngle = 78.0;  // degrees
constexpr double kGoldenSection = 0.6180339887498949;

std::vector<cv::Vec3f> labOf(const std::vector<SurfacePoint>& cloud) {
  cv::Mat rgb(1, static_cast<int>(cloud.size()), CV_32FC3);
  for (size_t i = 0; i < cloud.size(); ++i) rgb.at<cv::Vec3f>(static_cast<int>(i)) = cv::Vec3f(cloud[i].rgb) / 255.0f;
  std::vector<cv::Vec3f> lab(cloud.size());
  cv::Mat out(1, static_cast<int>(cloud.size()), CV_32FC3, lab.data());
  cv::cvtColor(rgb, out, cv::COLOR_RGB2Lab);
  return lab;
}

/// Distance of points[i] to its k-th nearest neighbour.
float neighbourDistance(const std::vector<Eigen::Vector3f>& points, size_t i) {
  std::vector<float> nearest(kSpacingNeighbours + 1, std::numeric_limits<float>::max());  // ascending; [0] is itself
  for (const Eigen::Vector3f& point : points) {
    const float d = (point - points[i]).squaredNorm();
    if (d >= nearest.back()) continue;
    nearest.back() = d;
    for (size_t j = nearest.size() - 1; j > 0 && nearest[j] < nearest[j - 1]; --j)
      std::swap(nearest[j], nearest[j - 1]);
  }
  return std::sqrt(nearest.back());
}

float coveringRadius(const std::vector<Eigen::Vector3f>& points) {
  const size_t step = std::max<size_t>(1, points.size() / kSpacingSamples);
  std::vector<float> distances;
  for (size_t i = 0; i < points.size(); i += step) distances.push_back(neighbourDistance(points, i));
  const auto at =
      distances.begin() + static_cast<std::ptrdiff_t>(kSpacingQuantile * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), at, distances.end());
  return *at;
}

void checkCloud(const ObjectModel& object) {
  if (object.cloud.size() < 4)
    throw std::invalid_argument("object " + object.name + " has a cloud of " + std::to_string(object.cloud.size()) +
                                " points");
  for (const SurfacePoint& point : object.cloud)
    if (!point.position.allFinite() || !point.normal.allFinite())
      throw std::invalid_argument("object " + object.name + " has a point or normal that is not finite");
}

/// Steps of the golden section over the cloud, so that any beginning is even.
ProbePoints probePoints(const PreparedModel& model) {
  ProbePoints points;
  const double size = static_cast<double>(model.positions.size());
  for (int i = 0; i < std::min(kProbePoints, static_cast<int>(model.positions.size())); ++i) {
    const double place = i * kGoldenSection;
    const auto k = static_cast<size_t>((place - std::floor(place)) * size);
    for (int axis = 0; axis < 3; ++axis) {
      points.position[axis].push_back(model.positions[k][axis]);
      points.normal[axis].push_back(model.normals[k][axis]);
    }
    points.lab.push_back(model.lab[k]);
  }
  return points;
}

/// Every `step`-th point: clouds are kept in an order that runs over the surface.
ModelCloud thinned(const ModelCloud& cloud, size_t step) {
  ModelCloud thin;
  for (size_t i = 0; i < cloud.positions.size(); i += step) {
    thin.positions.push_back(cloud.positions[i]);
    thin.normals.push_back(cloud.normals[i]);
    thin.lab.push_back(cloud.lab[i]);
  }
  thin.point_radius = coveringRadius(thin.positions);
  return thin;
}

FaceTable faceTable(const ProbePoints& points, double angle) {
  std::vector<Eigen::Vector3f> positions, normals, lab;
  for (size_t i = 0; i < points.lab.size(); ++i) {
    positions.emplace_back(points.position[0][i], points.position[1][i], points.position[2][i]);
    normals.emplace_back(points.normal[0][i], points.normal[1][i], points.normal[2][i]);
    lab.emplace_back(points.lab[i][0], points.lab[i][1], points.lab[i][2]);
  }
  return {positions, normals, lab, angle};
}

}  // namespace

PreparedModel prepareModel(const ObjectModel& object) {
  checkCloud(object);
  PreparedModel model;
  for (const SurfacePoint& point : object.cloud) {
    model.positions.push_back(point.position);
    model.normals.push_back(point.normal);
  }
  model.lab = labOf(object.cloud);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& position : model.positions) sum += position.cast<double>();
  model.centre = (sum / static_cast<double>(model.positions.size())).cast<float>();
  for (const Eigen::Vector3f& p : model.positions) model.radius = std::max(model.radius, (p - model.centre).norm());
  model.point_radius = coveringRadius(model.positions);
  model.coarse = thinned(model, kCoarseStep);
  model.shape = principalShape(model.positions);
  model.probe_points = probePoints(model);
  model.resting_poses = restingPoses(model.positions, model.centre);
  model.faces = faceTable(model.probe_points, kFaceAngle);
  model.halves = faceTable(model.probe_points, kHalfAngle);
  for (const auto& [type, features] : object.features)
    model.feature_frames.emplace(type, featureFrames(features, object.cloud));
  return model;
}

PreparedModels::PreparedModels(const ModelDatabase& database)
    : objects_(database.objects), slots_(new Slot[database.objects.size()]) {
  for (const auto& object : objects_)
    checkCloud(*object);  // here, as a throw from within a parallel loop would lose its type
}

void PreparedModels::prepareAll() const {
  cv::parallel_for_(
      cv::Range(0, count()),
      [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i) at(i);
      },
      count());
  cv::parallel_for_(
      cv::Range(0, count()),
      [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i) alternatives(i);
      },
      count());
}

const PreparedModel& PreparedModels::at(int index) const {
  const ObjectModel& object = *objects_.at(static_cast<size_t>(index));
  Slot& slot = slots_[static_cast<size_t>(index)];
  std::call_once(slot.once, [&] { slot.model = prepareModel(object); });
  return slot.model;
}

const std::vector<SymmetricAlternative>& PreparedModels::alternatives(int index) const {
  const PreparedModel& own = at(index);
  Slot& slot = slots_[static_cast<size_t>(index)];
  std::call_once(slot.once_alternatives, [&] {
    for (int other = 0; other < count(); ++other)
      for (const Pose& object_from_other : alignShapes(own, at(other)))
        if (other != index || rotationDistance(object_from_other, Pose::Identity()) > kSameRotation)
          slot.alternatives.push_back({other, object_from_other});
  });
  return slot.alternatives;
}

}  // namespace recognition
