#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "rgbd_recognition/meshes/mesh.h"
#include "meshes/texture_pyramid.h"

namespace recognition {

/// Colour and normal of a mesh anywhere on its triangles. `weights` are barycentric.
class TexturedSurface {
 public:
  explicit TexturedSurface(std::shared_ptr<const TexturedMesh> mesh);

  const TexturedMesh& mesh() const { return *mesh_; }

  /// BGR 0..255, averaged over a square of `width` metres; from the texture, else the vertices, else `plain`.
  Eigen::Vector3f colorAt(std::uint32_t triangle, const Eigen::Vector3f& weights, float width,
                          const Eigen::Vector3f& plain = Eigen::Vector3f::Constant(128.0f)) const;
  /// Unit normal interpolated between the vertices; those whose normal was smoothed over an edge (a box of twelve
  /// triangles) or that have none count with `geometric`, the triangle's.
  Eigen::Vector3f normalAt(std::uint32_t triangle, const Eigen::Vector3f& weights,
                           const Eigen::Vector3f& geometric) const;

 private:
  std::shared_ptr<const TexturedMesh> mesh_;
  std::unique_ptr<TexturePyramid> texture_;
  std::vector<float> densities_;  // texels a metre, by triangle
};

}  // namespace recognition
