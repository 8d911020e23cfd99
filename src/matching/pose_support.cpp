#include "matching/pose_support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <tuple>

#include "core/angles.h"
#include "core/simd.h"

namespace recognition {
namespace {

constexpr int kHalfRange = 1 << 20;  // cells on either side of the camera

/// A cell of a grid as wide as the radius: cells in order along x, then y, then z.
using Cell = std::int64_t;
constexpr Cell kNextY = Cell{1} << 21, kNextZ = Cell{1} << 42;

Cell cellOf(const Eigen::Vector3f& place, double radius) {
  const auto coordinate = [radius](float value) {
    const double index = std::clamp(std::floor(value / radius), -kHalfRange + 1.0, kHalfRange - 2.0);
    return static_cast<std::int64_t>(index) + kHalfRange;
  };
  return coordinate(place.x()) + coordinate(place.y()) * kNextY + coordinate(place.z()) * kNextZ;
}

Eigen::Vector3f meanOf(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& point : points) sum += point;
  return points.empty() ? sum : Eigen::Vector3f(sum / static_cast<float>(points.size()));
}

/// Where each correspondence puts the object. Sorted by the cell of its centre, so that three cells in a row along x
/// are one run; one coordinate after the other, for SIMD.
struct Proposals {
  std::vector<Cell> cell;
  std::vector<int> scene_feature, pair;
  std::array<std::vector<float>, 3> centre;
  std::array<std::vector<float>, 4> rotation;

  int size() const { return static_cast<int>(cell.size()); }
};

Proposals proposals(const std::vector<Correspondence>& pairs, const std::vector<Eigen::Quaternionf>& rotations,
                    const std::vector<Eigen::Vector3f>& scene_points, const std::vector<Eigen::Vector3f>& model_points,
                    double radius) {
  const Eigen::Vector3f middle = meanOf(model_points);
  std::vector<Eigen::Vector3f> centres(pairs.size());
  std::vector<std::tuple<Cell, int, int>> order(pairs.size());  // cell, scene feature, pair
  for (size_t i = 0; i < pairs.size(); ++i) {
    const int feature = pairs[i].scene_feature;
    centres[i] = scene_points[feature] + rotations[i] * (middle - model_points[pairs[i].model_feature]);
    order[i] = {cellOf(centres[i], radius), feature, static_cast<int>(i)};
  }
  std::sort(order.begin(), order.end());
  Proposals all;
  for (const auto& [cell, feature, pair] : order) {
    all.cell.push_back(cell);
    all.scene_feature.push_back(feature);
    all.pair.push_back(pair);
    for (int k = 0; k < 3; ++k) all.centre[k].push_back(centres[pair][k]);
    for (int k = 0; k < 4; ++k) all.rotation[k].push_back(rotations[pair].coeffs()[k]);
  }
  return all;
}

/// When two proposals are about the same.
struct Agreement {
  float squared_radius;
  float min_cosine;  ///< of half the angle between the rotations
};

using Marks = std::array<std::uint8_t, 512>;

/// Marks those of `count` proposals from `first` on that agree with `own`.
RGBD_SIMD_CLONES void markAgreeing(const Proposals& all, int own, int first, int count, Agreement limits,
                                   std::uint8_t* marks) {
  const float *x = all.centre[0].data(), *y = all.centre[1].data(), *z = all.centre[2].data();
  const float *a = all.rotation[0].data(), *b = all.rotation[1].data(), *c = all.rotation[2].data(),
              *d = all.rotation[3].data();
  const float own_x = x[own], own_y = y[own], own_z = z[own];
  const float own_a = a[own], own_b = b[own], own_c = c[own], own_d = d[own];
  for (int k = 0; k < count; ++k) {
    const int i = first + k;
    const float dx = x[i] - own_x, dy = y[i] - own_y, dz = z[i] - own_z;
    const float cosine = a[i] * own_a + b[i] * own_b + c[i] * own_c + d[i] * own_d;
    const bool near = dx * dx + dy * dy + dz * dz <= limits.squared_radius;
    marks[k] = static_cast<std::uint8_t>(near & (std::abs(cosine) >= limits.min_cosine));
  }
}

/// The proposals in a cell and those about it: nine runs of three cells. To be asked for cells in their order: each
/// run then only moves on.
class Neighbourhood {
 public:
  struct Run {
    int first = 0, end = 0;
  };
  explicit Neighbourhood(const std::vector<Cell>& cells) : cells_(cells) {}

  const std::array<Run, 9>& about(Cell cell) {
    if (cell == last_) return runs_;
    last_ = cell;
    const int size = static_cast<int>(cells_.size());
    Run* run = runs_.data();
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy, ++run) {
        const Cell row = cell + dy * kNextY + dz * kNextZ;
        while (run->first < size && cells_[run->first] < row - 1) ++run->first;
        run->end = std::max(run->end, run->first);
        while (run->end < size && cells_[run->end] <= row + 1) ++run->end;
      }
    }
    return runs_;
  }

 private:
  const std::vector<Cell>& cells_;
  std::array<Run, 9> runs_{};
  Cell last_ = -1;
};

}  // namespace

std::vector<int> poseSupport(const std::vector<Correspondence>& pairs, const std::vector<Eigen::Quaternionf>& rotations,
                             const std::vector<Eigen::Vector3f>& scene_points,
                             const std::vector<Eigen::Vector3f>& model_points, double radius, double max_rotation) {
  const Proposals all = proposals(pairs, rotations, scene_points, model_points, radius);
  const Agreement limits{static_cast<float>(radius * radius),
                         static_cast<float>(std::cos(0.5 * max_rotation * kDegree))};
  std::vector<int> support(pairs.size(), 0);
  std::vector<int> last_seen(scene_points.size(), -1);  // by scene feature: the proposal that counted it last
  Neighbourhood neighbourhood(all.cell);
  Marks marks;

  for (int own = 0; own < all.size(); ++own) {
    last_seen[all.scene_feature[own]] = own;
    for (const Neighbourhood::Run& run : neighbourhood.about(all.cell[own])) {
      for (int first = run.first; first < run.end; first += static_cast<int>(marks.size())) {
        const int count = std::min(static_cast<int>(marks.size()), run.end - first);
        markAgreeing(all, own, first, count, limits, marks.data());
        for (int k = 0; k < count; ++k) {
          const void* mark = std::memchr(&marks[k], 1, static_cast<size_t>(count - k));
          if (!mark) break;
          k = static_cast<int>(static_cast<const std::uint8_t*>(mark) - marks.data());
          if (last_seen[all.scene_feature[first + k]] == own) continue;
          last_seen[all.scene_feature[first + k]] = own;
          ++support[all.pair[own]];
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

}  // namespace recognition
