#include "object_base.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace rgbd_recognition {
namespace {

constexpr float kSlice = 0.012f;  // metres above the lowest measured height in which points outline the base
constexpr size_t kLeastPoints = 10;

SurfacePoint pointAt(float x, float y, float z) { return {{x, y, z}, -Eigen::Vector3f::UnitZ(), {}}; }

}  // namespace

std::vector<SurfacePoint> estimateBase(const std::vector<SurfacePoint>& cloud, float lowest, float spacing) {
  std::vector<cv::Point2f> outline, hull;
  for (const SurfacePoint& point : cloud)
    if (point.position.z() < lowest + kSlice) outline.emplace_back(point.position.x(), point.position.y());
  if (outline.size() < kLeastPoints) return {};
  cv::convexHull(outline, hull);
  std::vector<SurfacePoint> base;
  float left = hull[0].x, right = left, low = hull[0].y, high = low;
  for (const cv::Point2f& p : hull) {
    left = std::min(left, p.x), right = std::max(right, p.x);
    low = std::min(low, p.y), high = std::max(high, p.y);
  }
  for (float y = low; y <= high; y += spacing)
    for (float x = left; x <= right; x += spacing)
      if (cv::pointPolygonTest(hull, {x, y}, false) >= 0.0) base.push_back(pointAt(x, y, 0.0f));
  for (size_t i = 0; i < hull.size(); ++i) {
    const cv::Point2f a = hull[i], edge = hull[(i + 1) % hull.size()] - a;
    const int steps = std::max(1, cvRound(cv::norm(edge) / spacing));
    for (int k = 0; k < steps; ++k)
      for (float z = 0.5f * spacing; z < lowest; z += spacing)
        base.push_back(pointAt(a.x + edge.x * static_cast<float>(k) / static_cast<float>(steps),
                               a.y + edge.y * static_cast<float>(k) / static_cast<float>(steps), z));
  }
  return base;
}

}  // namespace rgbd_recognition
