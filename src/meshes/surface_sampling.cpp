#include "meshes/surface_sampling.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/angles.h"
#include "core/point_grid.h"
#include "meshes/textured_surface.h"
#include "meshes/mesh_renderer.h"

namespace recognition {
namespace {

constexpr int kCandidatesPerPoint = 5;     // thrown before thinning: more spread the points more evenly
constexpr int kVisibilityDirections = 48;  // from which a point may be seen
constexpr float kMinSeenCosine = 0.15f;    // of the angle between normal and direction that counts as seeing
constexpr float kRayOffset = 2e-5f;  // metres off the surface, so that a ray does not meet the triangle it starts from
constexpr float kSameFace = 0.7f;    // least cosine between normals of one sheet
constexpr float kSheetReach = 1.7f;  // about a point whose place is averaged, in the distance kept between points
// So many candidates thinned to a least distance r leave about 0.52 points a square of side r.
constexpr double kThinningDensity = 0.52;

struct Candidate {
  std::uint32_t triangle;
  Eigen::Vector3f weights;
};

float areaOf(const TexturedMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  return 0.5f * (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm();
}

std::vector<double> cumulativeAreas(const TexturedMesh& mesh) {
  std::vector<double> sums;
  double sum = 0.0;
  for (const auto& triangle : mesh.triangles) sums.push_back(sum += areaOf(mesh, triangle));
  return sums;
}

std::vector<Candidate> throwCandidates(const std::vector<double>& areas, int count) {
  cv::RNG rng(1);
  std::vector<Candidate> candidates(static_cast<size_t>(count));
  for (Candidate& candidate : candidates) {
    const double at = rng.uniform(0.0, areas.back());
    const auto found = std::upper_bound(areas.begin(), areas.end() - 1, at);
    const float r = std::sqrt(rng.uniform(0.0f, 1.0f)), s = rng.uniform(0.0f, 1.0f);
    candidate = {static_cast<std::uint32_t>(found - areas.begin()), {1.0f - r, r * (1.0f - s), r * s}};
  }
  return candidates;
}

// Turns the normal to the side from which the point is seen more; false if it is seen from neither.
bool orientOutwards(const MeshRenderer& renderer, const std::vector<Eigen::Vector3f>& directions, SurfacePoint& point) {
  float outside = 0.0f, inside = 0.0f;
  for (const Eigen::Vector3f& direction : directions) {
    const float cosine = point.normal.dot(direction);
    if (std::abs(cosine) < kMinSeenCosine) continue;
    const Eigen::Vector3f start = point.position + (cosine > 0.0f ? kRayOffset : -kRayOffset) * point.normal;
    if (!renderer.occluded(start, direction)) (cosine > 0.0f ? outside : inside) += std::abs(cosine);
  }
  if (inside > outside) point.normal = -point.normal;
  return outside + inside > 0.0f;
}

SurfacePoint pointAt(const TexturedSurface& surface, const Candidate& candidate, float color_width) {
  const TexturedMesh& mesh = surface.mesh();
  const auto& t = mesh.triangles[candidate.triangle];
  const Eigen::Vector3f& w = candidate.weights;
  const Eigen::Vector3f geometric =
      (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
  const Eigen::Vector3f bgr = surface.colorAt(candidate.triangle, w, color_width);
  return {
      w[0] * mesh.vertices[t[0]] + w[1] * mesh.vertices[t[1]] + w[2] * mesh.vertices[t[2]],
      surface.normalAt(candidate.triangle, w, geometric.stableNormalized()),
      cv::Vec3b(cv::saturate_cast<uchar>(bgr[2]), cv::saturate_cast<uchar>(bgr[1]), cv::saturate_cast<uchar>(bgr[0]))};
}

std::vector<SurfacePoint> visiblePoints(const TexturedSurface& surface, const MeshRenderer& renderer,
                                        const std::vector<Candidate>& candidates, float color_width) {
  const std::vector<Eigen::Vector3f> directions = sphereDirections(kVisibilityDirections);
  std::vector<SurfacePoint> points(candidates.size());
  std::vector<char> seen(candidates.size());
  cv::parallel_for_(cv::Range(0, static_cast<int>(candidates.size())), [&](const cv::Range& range) {
    for (auto i = static_cast<size_t>(range.start); i < static_cast<size_t>(range.end); ++i) {
      points[i] = pointAt(surface, candidates[i], color_width);
      seen[i] = orientOutwards(renderer, directions, points[i]);
    }
  });
  size_t kept = 0;
  for (size_t i = 0; i < points.size(); ++i)
    if (seen[i]) points[kept++] = points[i];
  points.resize(kept);
  return points;
}

}  // namespace

std::vector<Eigen::Vector3f> sphereDirections(int count) {
  const double golden_angle = kPi * (3.0 - std::sqrt(5.0));
  std::vector<Eigen::Vector3f> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    directions.push_back(
        Eigen::Vector3d(radius * std::cos(golden_angle * i), radius * std::sin(golden_angle * i), z).cast<float>());
  }
  return directions;
}

std::vector<SurfacePoint> thinSurface(const std::vector<SurfacePoint>& points, float distance) {
  PointGrid grid(distance);
  std::vector<SurfacePoint> kept;
  for (const SurfacePoint& point : points) {
    bool free = true;
    grid.forNeighbours(point.position, [&](int i) {
      const SurfacePoint& other = kept[static_cast<size_t>(i)];
      free = free && ((other.position - point.position).norm() >= distance || other.normal.dot(point.normal) < 0.0f);
    });
    if (!free) continue;
    grid.insert(point.position, static_cast<int>(kept.size()));
    kept.push_back(point);
  }
  return kept;
}

std::vector<SurfacePoint> thinMeasuredSurface(const std::vector<SurfacePoint>& points,
                                              const std::vector<float>& weights, float distance, float thickness) {
  const float reach = std::max(distance, thickness);
  PointGrid grid(reach);
  for (size_t i = 0; i < points.size(); ++i) grid.insert(points[i].position, static_cast<int>(i));
  std::vector<char> covered(points.size(), 0);
  std::vector<SurfacePoint> kept;
  for (size_t k = 0; k < points.size(); ++k) {
    if (covered[k]) continue;
    SurfacePoint sheet = points[k];
    float sum = 0.0f, weight = 0.0f;
    grid.forNeighbours(sheet.position, [&](int i) {
      const SurfacePoint& other = points[static_cast<size_t>(i)];
      const float facing = other.normal.dot(sheet.normal);
      const Eigen::Vector3f offset = other.position - sheet.position;
      const float along = offset.dot(sheet.normal), across = (offset - along * sheet.normal).norm();
      if (facing > kSameFace && std::abs(along) < thickness && across < kSheetReach * distance) {
        sum += weights[static_cast<size_t>(i)] * along;
        weight += weights[static_cast<size_t>(i)];
      }
      const bool same_sheet = facing > kSameFace && std::abs(along) < thickness && across < distance;
      if (same_sheet || (facing >= 0.0f && offset.norm() < distance)) covered[static_cast<size_t>(i)] = 1;
    });
    if (weight > 0.0f) sheet.position += sum / weight * sheet.normal;
    kept.push_back(sheet);
  }
  return kept;
}

std::vector<SurfacePoint> sampleSurface(const TexturedMesh& mesh, double spacing, int max_points) {
  const std::shared_ptr<const TexturedMesh> shared(std::shared_ptr<void>(), &mesh);
  const std::vector<double> areas = cumulativeAreas(mesh);
  const double area = areas.empty() ? 0.0 : areas.back();
  if (area <= 0.0) return {};
  const double used_spacing = std::max(spacing, std::sqrt(area / max_points));
  const int candidates = std::max(100, static_cast<int>(kCandidatesPerPoint * area / (used_spacing * used_spacing)));
  const std::vector<SurfacePoint> points =
      visiblePoints(TexturedSurface(shared), MeshRenderer({{shared}}), throwCandidates(areas, candidates),
                    static_cast<float>(used_spacing));
  return thinSurface(points, static_cast<float>(used_spacing * std::sqrt(kThinningDensity)));
}

}  // namespace recognition
