#include "rgbd_recognition/matching/pose_support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>

namespace rgbd_recognition {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr int kHalfRange = 1 << 20;  // cells on either side of the camera

/// A cell of a grid as wide as the radius: cells in order along x, then y, then z.
using Cell = std::int64_t;
constexpr Cell kNextY = Cell{1} << 21, kNextZ = Cell{1} << 42;

Cell cellOf(const Eigen::Vector3f& place, double radius) {
  const auto coordinate = [radius](float value) {
    const auto index = static_cast<std::int64_t>(std::floor(value / radius));
    return std::clamp<std::int64_t>(index, -kHalfRange + 1, kHalfRange - 2) + kHalfRange;
  };
  return coordinate(place.x()) + coordinate(place.y()) * kNextY + coordinate(place.z()) * kNextZ;
}

/// Where one correspondence puts the object.
struct Suggestion {
  Eigen::Vector3f centre;
  Cell cell = 0;  ///< of the centre
  Eigen::Quaternionf rotation;
  int scene_feature = 0;
  int pair = 0;
};

Eigen::Vector3f meanOf(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& point : points) sum += point;
  return points.empty() ? sum : Eigen::Vector3f(sum / static_cast<float>(points.size()));
}

/// Sorted by cell, so that three cells in a row along x are one run.
std::vector<Suggestion> suggestions(const std::vector<Correspondence>& pairs,
                                    const std::vector<Eigen::Quaternionf>& rotations,
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
    s.cell = cellOf(s.centre, radius);
  }
  std::sort(all.begin(), all.end(), [](const Suggestion& a, const Suggestion& b) {
    return std::tie(a.cell, a.scene_feature, a.pair) < std::tie(b.cell, b.scene_feature, b.pair);
  });
  return all;
}

/// Calls `use` with the suggestions in a cell and those about it. To be asked for the suggestions in their order: each
/// of the nine runs of three cells then only moves on.
class Neighbourhood {
 public:
  explicit Neighbourhood(const std::vector<Suggestion>& all) : all_(all) {}

  template <typename Use>
  void forEach(Cell cell, Use use) {
    size_t* run = runs_.data();
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy, ++run) {
        const Cell row = cell + dy * kNextY + dz * kNextZ;
        while (*run < all_.size() && all_[*run].cell < row - 1) ++*run;
        for (size_t i = *run; i < all_.size() && all_[i].cell <= row + 1; ++i) use(all_[i]);
      }
    }
  }

 private:
  const std::vector<Suggestion>& all_;
  std::array<size_t, 9> runs_{};  // where each begins
};

}  // namespace

std::vector<int> poseSupport(const std::vector<Correspondence>& pairs, const std::vector<Eigen::Quaternionf>& rotations,
                             const std::vector<Eigen::Vector3f>& scene_points,
                             const std::vector<Eigen::Vector3f>& model_points, double radius, double max_rotation) {
  const std::vector<Suggestion> all = suggestions(pairs, rotations, scene_points, model_points, radius);
  const auto squared_radius = static_cast<float>(radius * radius);
  const auto least_cosine = static_cast<float>(std::cos(0.5 * max_rotation * kDegree));
  std::vector<int> support(pairs.size(), 0);
  std::vector<int> last_seen(scene_points.size(), -1);  // by scene feature: the suggestion that counted it last
  Neighbourhood neighbourhood(all);

  for (size_t i = 0; i < all.size(); ++i) {
    const Suggestion& own = all[i];
    last_seen[own.scene_feature] = static_cast<int>(i);
    neighbourhood.forEach(own.cell, [&](const Suggestion& other) {
      if ((other.centre - own.centre).squaredNorm() > squared_radius) return;
      if (last_seen[other.scene_feature] == static_cast<int>(i)) return;
      if (std::abs(other.rotation.dot(own.rotation)) < least_cosine) return;
      last_seen[other.scene_feature] = static_cast<int>(i);
      ++support[own.pair];
    });
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
