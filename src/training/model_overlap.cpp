#include "training/model_overlap.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "training/cloud_finder.h"
#include "meshes/surface_sampling.h"

namespace recognition {
namespace {

constexpr float kSamePlace = 0.003f;        // metres between points whose colours are compared
constexpr double kMinTextureMatches = 3.0;  // standard deviation of brightness; less is no texture
constexpr double kSameUp = 0.01;            // of the sums: directions within about ten degrees, or opposite, are one
constexpr int kDirections = 150;
constexpr float kSameDirection = 0.97f;  // cosine, 14 degrees
constexpr int kMinFeatures = 5;          // seen from a direction that is looked from
constexpr float kCell = 0.005f;          // metres, of a map
constexpr float kFacing = 0.3f;          // least cosine between a surface that is seen and the direction
constexpr float kInFront = 0.004f;       // metres
constexpr float kBelow = 0.003f;         // metres below what an object stood on
constexpr float kNothing = -1e9f;

float brightness(const SurfacePoint& point) {
  return static_cast<float>(point.rgb[0]) + static_cast<float>(point.rgb[1]) + static_cast<float>(point.rgb[2]);
}

// Away from what the object stood on first; zero where that is not known.
Eigen::Vector3f upOf(const ObjectModel& model) {
  return model.rest_planes.empty() ? Eigen::Vector3f::Zero() : model.rest_planes.front().normal;
}

// Directions from which the object was seen, by its features.
std::vector<Eigen::Vector3f> viewDirections(const ObjectModel& model) {
  std::vector<Eigen::Vector3f> directions;
  for (const Eigen::Vector3f& direction : sphereDirections(kDirections)) {
    int features = 0;
    for (const auto& [type, of_type] : model.features)
      for (const Eigen::Vector3f& view : of_type.view_directions) features += view.dot(direction) > kSameDirection;
    if (features >= kMinFeatures) directions.push_back(direction);
  }
  return directions;
}

// How far a cloud reaches towards `direction`, by place across it; kNothing where it was not seen.
class ReachMap {
 public:
  ReachMap(const std::vector<SurfacePoint>& cloud, const Eigen::Vector3f& direction)
      : direction_(direction), x_(direction.unitOrthogonal()), y_(direction.cross(x_)) {
    Eigen::Vector2f high = Eigen::Vector2f::Constant(kNothing);
    low_ = -high;
    for (const SurfacePoint& point : cloud) low_ = low_.cwiseMin(across(point)), high = high.cwiseMax(across(point));
    const Eigen::Vector2i size = ((high - low_) / kCell).array().floor().cast<int>() + 1;
    cv::Mat reach(size.y(), size.x(), CV_32FC1, cv::Scalar(kNothing)), facing = reach.clone();
    for (const SurfacePoint& point : cloud) {
      const cv::Point at = placeOf(point);
      auto& front = reach.at<float>(at);
      if (point.position.dot(direction) < front) continue;
      front = point.position.dot(direction);
      facing.at<float>(at) = point.normal.dot(direction) > kFacing ? front : kNothing;
    }
    cv::dilate(facing, reach_, cv::Mat());  // the farthest of the cells around: edges are not known to a cell
    reach_.setTo(kNothing, facing <= kNothing);
  }

  bool isBehind(const SurfacePoint& point) const {
    const cv::Point at = placeOf(point);
    if (!cv::Rect({}, reach_.size()).contains(at) || reach_.at<float>(at) <= kNothing) return false;
    return reach_.at<float>(at) + kInFront < point.position.dot(direction_);
  }

 private:
  Eigen::Vector2f across(const SurfacePoint& point) const { return {point.position.dot(x_), point.position.dot(y_)}; }
  cv::Point placeOf(const SurfacePoint& point) const {
    const Eigen::Vector2i at = ((across(point) - low_) / kCell).array().floor().cast<int>();
    return {at.x(), at.y()};
  }

  Eigen::Vector3f direction_, x_, y_;
  Eigen::Vector2f low_;
  cv::Mat reach_;
};

// Points of `cloud` below what the other model stood on, or that its views would have seen in front of what they saw.
int countContradicted(const ObjectModel& model, const std::vector<SurfacePoint>& cloud) {
  std::vector<char> contradicted(cloud.size(), 0);
  for (const Eigen::Vector3f& direction : viewDirections(model)) {
    const ReachMap map(model.cloud, direction);
    for (size_t i = 0; i < cloud.size(); ++i) contradicted[i] |= map.isBehind(cloud[i]) ? 1 : 0;
  }
  for (const RestPlane& plane : model.rest_planes)
    for (size_t i = 0; i < cloud.size(); ++i) contradicted[i] |= plane.heightOf(cloud[i].position) < -kBelow ? 1 : 0;
  return static_cast<int>(std::count(contradicted.begin(), contradicted.end(), 1));
}

}  // namespace

double textureCorrelation(const ObjectModel& model, const ObjectModel& addition, const Pose& model_from_addition) {
  const CloudFinder finder(model.cloud, kSamePlace);
  const Eigen::Isometry3f pose(model_from_addition.cast<float>());
  const Eigen::Vector3f up = upOf(model), other_up = pose.linear() * upOf(addition);
  using Sums = Eigen::Matrix<double, 5, 5>;  // of brightness in both, and of what explains it without any texture
  Sums sums = Sums::Zero();
  for (const SurfacePoint& point : addition.cloud) {
    const SurfacePoint* pair = finder.nearest(pose * point.position, pose.linear() * point.normal);
    if (!pair) continue;
    Eigen::Matrix<double, 5, 1> seen;
    seen << brightness(point), brightness(*pair), pair->normal.dot(up), pair->normal.dot(other_up), 1.0;
    sums += seen * seen.transpose();
  }
  // Of brightness less its regression on how far the surface looks up: the Schur complement of the sums.
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix3d> light;
  light.setThreshold(kSameUp);
  light.compute(sums.bottomRightCorner<3, 3>());
  const Eigen::Matrix2d texture =
      sums.topLeftCorner<2, 2>() - sums.topRightCorner<2, 3>() * light.solve(sums.bottomLeftCorner<3, 2>());
  if (texture.diagonal().minCoeff() <= kMinTextureMatches * kMinTextureMatches * sums(4, 4)) return 0.0;
  return texture(0, 1) / std::sqrt(texture(0, 0) * texture(1, 1));
}

double contradictedShare(const ObjectModel& model, const ObjectModel& addition, const Pose& model_from_addition) {
  const ObjectModel added = moved(addition, model_from_addition);
  const int contradicted = countContradicted(model, added.cloud) + countContradicted(added, model.cloud);
  return contradicted / static_cast<double>(model.cloud.size() + added.cloud.size());
}

}  // namespace recognition
