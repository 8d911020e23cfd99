#include "meshes/smooth_normals.h"

#include <algorithm>
#include <numeric>

#include <Eigen/Geometry>

namespace recognition {
namespace {

constexpr double kMinFaceCosine = 0.5;  // between faces that are smoothed together
constexpr size_t kMaxAround = 64;       // faces about a position; with more they are not compared with each other

bool isLess(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// Twice the area times the unit normal.
Eigen::Vector3d areaVector(const RawMesh& mesh, const RawFace& face) {
  const auto at = [&](size_t i) -> const Eigen::Vector3d& {
    return mesh.positions[static_cast<size_t>(mesh.corners[face.first + i].position)];
  };
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (size_t i = 1; i + 1 < face.count; ++i) sum += (at(i) - at(0)).cross(at(i + 1) - at(0));
  return sum;
}

class Smoother {
 public:
  explicit Smoother(RawMesh& mesh) : mesh_(mesh) {
    for (size_t f = 0; f < mesh.faces.size(); ++f) {
      const RawFace& face = mesh.faces[f];
      areas_.push_back(areaVector(mesh, face));
      units_.push_back(areas_.back().stableNormalized());
      for (size_t i = 0; i < face.count; ++i) {
        corners_.push_back(face.first + i);
        faces_.push_back(static_cast<std::uint32_t>(f));
      }
    }
  }

  void run() {
    std::vector<std::uint32_t> order(corners_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      if (isLess(place(a), place(b))) return true;
      return !isLess(place(b), place(a)) && a < b;
    });
    for (size_t first = 0; first < order.size();) {
      size_t last = first + 1;
      while (last < order.size() && place(order[last]) == place(order[first])) ++last;
      smooth({order.begin() + static_cast<std::ptrdiff_t>(first), order.begin() + static_cast<std::ptrdiff_t>(last)});
      first = last;
    }
  }

 private:
  const Eigen::Vector3d& place(std::uint32_t i) const {
    return mesh_.positions[static_cast<size_t>(mesh_.corners[corners_[i]].position)];
  }

  Eigen::Vector3d normalAmong(const std::vector<std::uint32_t>& group, const Eigen::Vector3d& own) const {
    if (group.size() > kMaxAround) return own;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::uint32_t other : group)
      if (units_[faces_[other]].dot(own) > kMinFaceCosine) sum += areas_[faces_[other]];
    return sum.stableNormalized();
  }

  // Corners at one place, which share the normals that are the same.
  void smooth(const std::vector<std::uint32_t>& group) {
    const size_t first = mesh_.normals.size();
    for (const std::uint32_t i : group) {
      RawCorner& corner = mesh_.corners[corners_[i]];
      if (corner.normal >= 0) continue;
      const Eigen::Vector3f normal = normalAmong(group, units_[faces_[i]]).cast<float>();
      const size_t from = std::max(first, mesh_.normals.size() - std::min(mesh_.normals.size(), kMaxAround));
      const auto known =
          std::find(mesh_.normals.begin() + static_cast<std::ptrdiff_t>(from), mesh_.normals.end(), normal);
      corner.normal = known - mesh_.normals.begin();
      if (known == mesh_.normals.end()) mesh_.normals.push_back(normal);
    }
  }

  RawMesh& mesh_;
  std::vector<Eigen::Vector3d> areas_, units_;  // by face
  std::vector<size_t> corners_;                 // of all faces, in their order
  std::vector<std::uint32_t> faces_;            // of those corners
};

}  // namespace

void addMissingNormals(RawMesh& mesh) {
  const bool complete =
      std::all_of(mesh.corners.begin(), mesh.corners.end(), [](const RawCorner& corner) { return corner.normal >= 0; });
  if (!complete) Smoother(mesh).run();
}

}  // namespace recognition
