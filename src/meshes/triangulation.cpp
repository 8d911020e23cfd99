#include "meshes/triangulation.h"

#include <cmath>

#include <Eigen/Geometry>

namespace recognition {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// In the polygon's plane, counter-clockwise.
std::vector<Eigen::Vector2d> projected(const std::vector<Eigen::Vector3d>& corners) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // Newell's
  for (size_t i = 0; i < corners.size(); ++i)
    normal += (corners[i] - corners[0]).cross(corners[(i + 1) % corners.size()] - corners[0]);
  const Eigen::Vector3d unit = normal.norm() > 0.0 ? normal.normalized() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d x = unit.unitOrthogonal(), y = unit.cross(x);
  std::vector<Eigen::Vector2d> points;
  for (const Eigen::Vector3d& corner : corners)
    points.emplace_back((corner - corners[0]).dot(x), (corner - corners[0]).dot(y));
  return points;
}

bool isInside(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return cross(b - a, p - a) > 0.0 && cross(c - b, p - b) > 0.0 && cross(a - c, p - c) > 0.0;
}

/// Cuts off one corner after the other that no other corner lies in.
class EarClipping {
 public:
  explicit EarClipping(const std::vector<Eigen::Vector3d>& corners) : points_(projected(corners)) {
    for (std::uint32_t i = 0; i < corners.size(); ++i) left_.push_back(i);
  }

  std::vector<std::array<std::uint32_t, 3>> run() {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    while (left_.size() > 3) {
      const size_t ear = findEar(), n = left_.size();
      triangles.push_back({left_[(ear + n - 1) % n], left_[ear], left_[(ear + 1) % n]});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear));
      last_ = ear % left_.size();
    }
    triangles.push_back({left_[0], left_[1], left_[2]});
    return triangles;
  }

 private:
  size_t findEar() const {
    for (size_t i = 0; i < left_.size(); ++i)
      if (const size_t at = (last_ + i) % left_.size(); isEar(at)) return at;
    return last_;  // none: the polygon crosses itself
  }

  bool isEar(size_t at) const {
    const size_t n = left_.size();
    const auto &a = points_[left_[(at + n - 1) % n]], &b = points_[left_[at]], &c = points_[left_[(at + 1) % n]];
    if (cross(b - a, c - b) <= 0.0) return false;
    for (size_t i = 0; i < n; ++i)
      if (i != at && i != (at + 1) % n && i != (at + n - 1) % n && isInside(points_[left_[i]], a, b, c)) return false;
    return true;
  }

  std::vector<Eigen::Vector2d> points_;
  std::vector<std::uint32_t> left_;
  size_t last_ = 1;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<Eigen::Vector3d>& corners) {
  if (corners.size() < 3) return {};
  if (corners.size() == 3) return {{0, 1, 2}};
  return EarClipping(corners).run();
}

}  // namespace recognition
