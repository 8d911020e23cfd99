#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace recognition {

/// Triangles of a plane polygon, which may be concave: indices of its corners. n - 2 triangles for n corners, also
/// where the polygon is no simple one.
std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<Eigen::Vector3d>& corners);

}  // namespace recognition
