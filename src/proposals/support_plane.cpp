#include "proposals/support_plane.h"

#include <algorithm>
#include <random>
#include <vector>

#include <Eigen/Dense>

namespace recognition {
namespace {

constexpr int kStep = 6;      // pixels between samples
constexpr size_t kMin = 150;  // samples
constexpr int kDraws = 150;
constexpr float kNear = 0.012f;  // metres
constexpr float kMinShare = 0.2f;
constexpr float kRising = -0.2f;  // y of the normal of a plane that is seen from above, y down; a wall's is about 0

std::vector<Eigen::Vector3f> planePoints(const SceneView& scene) {
  std::vector<Eigen::Vector3f> points;
  const cv::Mat& labels = scene.segmentation->labels;
  for (int v = 0; v < labels.rows; v += kStep)
    for (int u = 0; u < labels.cols; u += kStep) {
      const float z = scene.depth.at<float>(v, u);
      if (labels.at<int>(v, u) != kLargePlane || z <= 0.0f) continue;
      points.push_back(scene.camera.unproject(u, v, z).cast<float>());
    }
  return points;
}

/// Turned to the camera's side.
SupportPlane planeOf(const Eigen::Vector3f& normal, const Eigen::Vector3f& point) {
  const float height = normal.dot(point);
  return height <= 0.0f ? SupportPlane{normal, height} : SupportPlane{-normal, -height};
}

bool isNear(const SupportPlane& plane, const Eigen::Vector3f& point) {
  return std::abs(plane.up.dot(point) - plane.height) < kNear;
}

SupportPlane fit(const std::vector<Eigen::Vector3f>& points, const SupportPlane& plane) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  double count = 0.0;
  for (const Eigen::Vector3f& point : points) {
    if (!isNear(plane, point)) continue;
    const Eigen::Vector3d p = point.cast<double>();
    sum += p;
    squares += p * p.transpose();
    ++count;
  }
  const Eigen::Vector3d mean = sum / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / count - mean * mean.transpose());
  return planeOf(solver.eigenvectors().col(0).cast<float>(), mean.cast<float>());
}

}  // namespace

std::optional<SupportPlane> findSupportPlane(const SceneView& scene) {
  const std::vector<Eigen::Vector3f> points = planePoints(scene);
  if (points.size() < kMin) return std::nullopt;
  std::mt19937 random(1);
  const auto draw = [&] { return points[random() % points.size()]; };
  SupportPlane best, rising;
  std::ptrdiff_t most = 0, max_rising = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector3f a = draw(), b = draw(), c = draw(), normal = (b - a).cross(c - a);
    if (normal.norm() < 1e-4f) continue;
    const SupportPlane plane = planeOf(normal.normalized(), a);
    const auto count = std::count_if(points.begin(), points.end(), [&](const auto& p) { return isNear(plane, p); });
    if (count > most) {
      most = count;
      best = plane;
    }
    if (plane.up.y() < kRising && count > max_rising) {
      max_rising = count;
      rising = plane;
    }
  }
  const auto least = static_cast<std::ptrdiff_t>(kMinShare * static_cast<float>(points.size()));
  if (max_rising > least) return fit(points, rising);
  if (most > least) return fit(points, best);
  return std::nullopt;
}

}  // namespace recognition
