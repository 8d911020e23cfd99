#include "meshes/textured_surface.h"

#include <cmath>

#include <Eigen/Geometry>

namespace recognition {
namespace {

constexpr float kMinSmoothCosine = 0.75f;  // of a vertex's normal to the triangle's; less is smoothed over an edge

template <typename Values>
auto interpolate(const Values& values, const std::array<std::uint32_t, 3>& t, const Eigen::Vector3f& weights) {
  return (weights[0] * values[t[0]] + weights[1] * values[t[1]] + weights[2] * values[t[2]]).eval();
}

std::vector<float> texelDensities(const TexturedMesh& mesh, cv::Size size) {
  std::vector<float> densities;
  densities.reserve(mesh.triangles.size());
  const Eigen::Array2f scale(static_cast<float>(size.width), static_cast<float>(size.height));
  for (const auto& t : mesh.triangles) {
    const Eigen::Array2f a = (mesh.texture_coordinates[t[1]] - mesh.texture_coordinates[t[0]]).array() * scale;
    const Eigen::Array2f b = (mesh.texture_coordinates[t[2]] - mesh.texture_coordinates[t[0]]).array() * scale;
    const Eigen::Vector3f p = mesh.vertices[t[1]] - mesh.vertices[t[0]];
    const Eigen::Vector3f q = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    const float area = p.cross(q).norm();
    densities.push_back(area > 0.0f ? std::sqrt(std::abs(a.x() * b.y() - a.y() * b.x()) / area) : 0.0f);
  }
  return densities;
}

}  // namespace

TexturedSurface::TexturedSurface(std::shared_ptr<const TexturedMesh> mesh) : mesh_(std::move(mesh)) {
  if (mesh_->texture.empty() || mesh_->texture_coordinates.empty()) return;
  texture_ = std::make_unique<TexturePyramid>(*mesh_);
  densities_ = texelDensities(*mesh_, texture_->size());
}

Eigen::Vector3f TexturedSurface::colorAt(std::uint32_t triangle, const Eigen::Vector3f& weights, float width,
                                         const Eigen::Vector3f& plain) const {
  const auto& t = mesh_->triangles[triangle];
  if (texture_)
    return texture_->sample(interpolate(mesh_->texture_coordinates, t, weights), width * densities_[triangle]);
  if (mesh_->vertex_colors.empty()) return plain;
  Eigen::Vector3f bgr = Eigen::Vector3f::Zero();
  for (int k = 0; k < 3; ++k) {
    const cv::Vec3b& rgb = mesh_->vertex_colors[t[static_cast<size_t>(k)]];
    bgr += weights[k] * Eigen::Vector3f(rgb[2], rgb[1], rgb[0]);
  }
  return bgr;
}

Eigen::Vector3f TexturedSurface::normalAt(std::uint32_t triangle, const Eigen::Vector3f& weights,
                                          const Eigen::Vector3f& geometric) const {
  if (mesh_->normals.empty()) return geometric;
  const auto& t = mesh_->triangles[triangle];
  const Eigen::Vector3f sum = mesh_->normals[t[0]] + mesh_->normals[t[1]] + mesh_->normals[t[2]];
  const Eigen::Vector3f flat = geometric.dot(sum) < 0.0f ? -geometric : geometric;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3f& corner = mesh_->normals[t[static_cast<size_t>(k)]];
    normal += weights[k] * (corner.dot(flat) > kMinSmoothCosine ? corner : flat);
  }
  return normal.normalized();
}

}  // namespace recognition
