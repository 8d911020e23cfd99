#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace recognition {

/// Points by index in cubic cells, to find those near a place.
class PointGrid {
 public:
  explicit PointGrid(float cell) : cell_(cell) {}

  void insert(const Eigen::Vector3f& position, int index) { cells_[key(cellOf(position))].push_back(index); }

  /// Calls visit(index) for all points in the 27 cells around: all that are nearer than one cell's side, and some
  /// farther ones.
  template <typename Visit>
  void forNeighbours(const Eigen::Vector3f& position, Visit visit) const {
    const Eigen::Vector3i centre = cellOf(position);
    for (int i = 0; i < 27; ++i) {
      const auto found = cells_.find(key(centre + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
      if (found == cells_.end()) continue;
      for (const int index : found->second) visit(index);
    }
  }

 private:
  Eigen::Vector3i cellOf(const Eigen::Vector3f& p) const { return (p / cell_).array().floor().cast<int>(); }
  static std::uint64_t key(const Eigen::Vector3i& c) {
    const auto part = [](int x) { return static_cast<std::uint64_t>(x) & 0x1fffff; };
    return part(c.x()) << 42 | part(c.y()) << 21 | part(c.z());
  }

  float cell_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

}  // namespace recognition
