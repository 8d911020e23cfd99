#include "rgbd_recognition/matching/pose_support.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>

namespace rgbd_recognition {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr int kHalfRange = 1 << 20;  // cells on either side of the camera

/// Where one correspondence puts the object.
struct Suggestion {
  std::int64_t cell = 0;  ///< of the centre, in a grid as wide as the radius
  Eigen::Vector3f centre;
  Eigen::Quaternionf rotation;
  int scene_feature = 0;
  int pair = 0;
};

std::int64_t cellOf(int x, int y, int z) {
  const auto part = [](int i) { return static_cast<std::int64_t>(std::clamp(i, -kHalfRange + 1, kHalfRange - 2) + kHalfRange); };
  return (part(z) << 42) | (part(y) << 21) | part(x);
}

int coordinate(float value, double radius) { return static_cast<int>(std::floor(value / radius)); }

Eigen::Vector3f meanOf(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& point : points) sum += point;
  return points.empty() ? sum : Eigen::Vector3f(sum / static_cast<float>(points.size()));
}

/// Sorted by cell, so that three cells in a row along x are one run.
std::vector<Suggestion> suggestions(const std::vector<Correspondence>& pairs, const std::vector<Eigen::Quaternionf>& rotations,
                                    const std::vector<Eigen::Vector3f>& scene_points,
                                    const std::vector<Eigen::Vector3f>& model_points, double radius) {
  const Eigen::Vector3f middle = meanOf(model_points);
  std::vector<Suggestion> all(pairs.size());
  for (size_t i = 0; i < pairs.size(); ++i) {
    Suggestion& s = all[i];
    s.rotation = rotations[i];
    s.scene_feature = pairs[i].scene_feature;
    s.pair = static_cast<int>(i);
    s.centre = scene_points[pairs[i].scene_feature] + s.rotation * (middle - model_points[pairs[i].model_feature]);
    s.cell = cellOf(coordinate(s.centre.x(), radius), coordinate(s.centre.y(), radius), coordinate(s.centre.z(), radius));
  }
  std::sort(all.begin(), all.end(), [](const Suggestion& a, const Suggestion& b) {
    return std::tie(a.cell, a.scene_feature, a.pair) < std::tie(b.cell, b.scene_feature, b.pair);
  });
  return all;
}

}  // namespace

std::vector<int> poseSupport(const std::vector<Correspondence>& pairs, const std::vector<Eigen::Quaternionf>& rotations,
                             const std::vector<Eigen::Vector3f>& scene_points, const std::vector<Eigen::Vector3f>& model_points,
                             double radius, double max_rotation) {
  const std::vector<Suggestion> all = suggestions(pairs, rotations, scene_points, model_points, radius);
  const auto squared_radius = static_cast<float>(radius * radius);
  const auto least_cosine = static_cast<float>(std::cos(0.5 * max_rotation * kDegree));
  std::vector<int> support(pairs.size(), 0);
  std::vector<int> last_seen;  // by scene feature: the suggestion that counted it last
  for (const Suggestion& s : all) last_seen.resize(std::max(last_seen.size(), static_cast<size_t>(s.scene_feature) + 1), -1);

  for (size_t i = 0; i < all.size(); ++i) {
    const Suggestion& own = all[i];
    last_seen[own.scene_feature] = static_cast<int>(i);
    const int x = coordinate(own.centre.x(), radius), y = coordinate(own.centre.y(), radius), z = coordinate(own.centre.z(), radius);
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        const std::int64_t last = cellOf(x + 1, y + dy, z + dz);
        auto other = std::lower_bound(all.begin(), all.end(), cellOf(x - 1, y + dy, z + dz),
                                      [](const Suggestion& s, std::int64_t cell) { return s.cell < cell; });
        for (; other != all.end() && other->cell <= last; ++other) {
          if (last_seen[other->scene_feature] == static_cast<int>(i)) continue;
          if ((other->centre - own.centre).squaredNorm() > squared_radius) continue;
          if (std::abs(other->rotation.dot(own.rotation)) < least_cosine) continue;
          last_seen[other->scene_feature] = static_cast<int>(i);
          ++support[own.pair];
        }
      }
    }
  }
  return support;
}

std::vector<Correspondence> sortBySupport(const std::vector<Correspondence>& pairs, const std::vector<int>& support) {
  std::vector<int> order(pairs.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return support[a] > support[b]; });
  std::vector<Correspondence> sorted;
  sorted.reserve(pairs.size());
  for (const int i : order) sorted.push_back(pairs[i]);
  return sorted;
}

}  // namespace rgbd_recognition
