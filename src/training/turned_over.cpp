#include "training/turned_over.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "core/angles.h"

namespace recognition {
namespace {

constexpr float kTopShare = 0.998f;         // of the points that lie below an object's top
constexpr float kSameHeight = 0.008f;       // metres between the heights of one object in two recordings
constexpr float kFacing = -0.7f;            // greatest cosine between a plane's normal and that of what faces it
constexpr float kLayer = 0.002f;            // metres above the lowest points
constexpr float kFarthestContact = 0.012f;  // metres
constexpr size_t kMinContact = 20;          // points

float quantile(std::vector<float> values, float share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<float>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

float heightAbove(const RestPlane& plane, const std::vector<SurfacePoint>& cloud) {
  std::vector<float> heights;
  for (const SurfacePoint& point : cloud) heights.push_back(plane.heightOf(point.position));
  return quantile(std::move(heights), kTopShare);
}

// z up from the plane, the origin on it below the cloud's middle.
Pose planeFromModel(const ObjectModel& model) {
  const RestPlane& plane = model.rest_planes.front();
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  for (const SurfacePoint& point : model.cloud) middle += point.position / static_cast<float>(model.cloud.size());
  const Eigen::Vector3f origin = middle - plane.heightOf(middle) * plane.normal;
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond::FromTwoVectors(plane.normal.cast<double>(), Eigen::Vector3d::UnitZ()).matrix();
  pose.translation() = -(pose.linear() * origin.cast<double>());
  return pose;
}

// What of a cloud touches a plane, and how high that is above it; no points if it is not touched at all.
struct Touch {
  std::vector<SurfacePoint> points;
  float height = 0.0f;
};

Touch touchOf(const RestPlane& plane, const std::vector<SurfacePoint>& cloud) {
  std::vector<std::pair<float, const SurfacePoint*>> facing;
  for (const SurfacePoint& point : cloud)
    if (point.normal.dot(plane.normal) < kFacing) facing.emplace_back(plane.heightOf(point.position), &point);
  if (facing.size() < kMinContact) return {};
  std::sort(facing.begin(), facing.end());
  Touch touch;
  for (size_t i = 0; i < kMinContact; ++i) touch.height += facing[i].first / static_cast<float>(kMinContact);
  if (std::abs(touch.height) > kFarthestContact) return {};
  for (const auto& [height, point] : facing)
    if (height < touch.height + kLayer) touch.points.push_back(*point);
  return touch;
}

}  // namespace

std::vector<Pose> turnedOverPoses(const ObjectModel& model, const ObjectModel& addition, double step) {
  if (model.rest_planes.empty() || addition.rest_planes.empty() || model.cloud.empty() || addition.cloud.empty())
    return {};
  const float height = heightAbove(model.rest_planes.front(), model.cloud),
              other = heightAbove(addition.rest_planes.front(), addition.cloud);
  if (std::abs(height - other) > kSameHeight) return {};
  const Pose over =
      Eigen::Translation3d(0.0, 0.0, 0.5 * (height + other)) * Pose(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
  const Pose model_from_plane = planeFromModel(model).inverse(), plane_from_addition = planeFromModel(addition);
  std::vector<Pose> poses;
  for (double turn = 0.0; turn < 360.0; turn += step)
    poses.push_back(model_from_plane * Eigen::AngleAxisd(turn * kPi / 180.0, Eigen::Vector3d::UnitZ()) * over *
                    plane_from_addition);
  return poses;
}

bool isTurnedOver(const ObjectModel& model, const ObjectModel& added) {
  for (const RestPlane& plane : model.rest_planes)
    for (const RestPlane& other : added.rest_planes)
      if (plane.normal.dot(other.normal) > kFacing) return false;
  return true;
}

bool isWhole(const ObjectModel& model) {
  return std::all_of(model.rest_planes.begin(), model.rest_planes.end(),
                     [&](const RestPlane& plane) { return !touchOf(plane, model.cloud).points.empty(); });
}

std::vector<Contact> contactsOf(const ObjectModel& model, const ObjectModel& addition,
                                const Pose& model_from_addition) {
  std::vector<Contact> contacts;
  ObjectModel added;
  added.cloud = addition.cloud;
  added.rest_planes = addition.rest_planes;
  added = moved(std::move(added), model_from_addition);
  for (const RestPlane& plane : model.rest_planes) {
    const Touch touch = touchOf(plane, added.cloud);
    for (const SurfacePoint& point : touch.points)
      contacts.push_back({point.position, {point.position - touch.height * plane.normal, plane.normal, {}}});
  }
  for (const RestPlane& plane : added.rest_planes) {
    const Touch touch = touchOf(plane, model.cloud);
    for (const SurfacePoint& point : touch.points)
      contacts.push_back({point.position - touch.height * plane.normal, {point.position, plane.normal, {}}});
  }
  return contacts;
}

}  // namespace recognition
