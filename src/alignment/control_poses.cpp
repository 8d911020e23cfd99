#include "alignment/control_poses.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"

namespace recognition {
namespace {

constexpr double kSlide = 0.02;     // metres
constexpr double kRotation = 20.0;  // degrees
constexpr int kSamples = 200;       // points of the model

/// Mean normal of what faces the camera, and the middle of it; camera's frame.
void meanPlane(const PreparedModel& model, const Pose& pose, Eigen::Vector3d* normal, Eigen::Vector3d* middle) {
  *normal = *middle = Eigen::Vector3d::Zero();
  double facing = 0.0;
  const ProbePoints& points = model.probe_points;
  for (int i = 0; i < std::min(kSamples, points.count()); ++i) {
    const auto k = static_cast<size_t>(i);
    const Eigen::Vector3d p =
        pose * Eigen::Vector3d(points.position[0][k], points.position[1][k], points.position[2][k]);
    const Eigen::Vector3d n =
        pose.linear() * Eigen::Vector3d(points.normal[0][k], points.normal[1][k], points.normal[2][k]);
    if (n.dot(p) >= 0.0) continue;
    *normal += n;
    *middle += p;
    ++facing;
  }
  *middle /= std::max(1.0, facing);
  if (normal->norm() < 1e-9) *normal = -middle->normalized();
  normal->normalize();
}

}  // namespace

std::vector<Pose> controlPoses(const PreparedModel& model, const Pose& camera_from_object) {
  Eigen::Vector3d normal, middle;
  meanPlane(model, camera_from_object, &normal, &middle);
  const Eigen::Vector3d along = normal.unitOrthogonal(), across = normal.cross(along);
  std::vector<Pose> poses;
  for (int i = 0; i < 4; ++i) {
    const double angle = 0.5 * kPi * i;
    poses.push_back(Eigen::Translation3d(kSlide * (std::cos(angle) * along + std::sin(angle) * across)) *
                    camera_from_object);
  }
  for (const double degrees : {-kRotation, kRotation})
    poses.push_back(Eigen::Translation3d(middle) * Eigen::AngleAxisd(degrees * kPi / 180.0, normal) *
                    Eigen::Translation3d(-middle) * camera_from_object);
  return poses;
}

double colorPeak(const PreparedModel& model, int points, const Pose& camera_from_object, const SceneView& scene,
                 const ProbeLimits& limits, const std::function<bool(double peak)>& hopeless) {
  const double own = probeSurface(model, points, camera_from_object, scene, limits).correlation;
  double best = -1.0;
  for (const Pose& control : controlPoses(model, camera_from_object)) {
    best = std::max(best, probeSurface(model, points, control, scene, limits).correlation);
    if (hopeless && hopeless(own - best)) break;
  }
  return own - best;
}

}  // namespace recognition
