#include "rgbd_recognition/simulation/scene.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace rgbd_recognition {
namespace {

const float kDisplayGamma = 2.2f;
const Eigen::Vector3f kUntextured(186.0f, 186.0f, 186.0f);

// Texels of the finest level in a metre on each triangle.
std::vector<float> texelDensities(const TexturedMesh& mesh) {
  std::vector<float> densities;
  densities.reserve(mesh.triangles.size());
  const Eigen::Vector2f size(static_cast<float>(mesh.texture.cols), static_cast<float>(mesh.texture.rows));
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector2f a = (mesh.texture_coordinates[t[1]] - mesh.texture_coordinates[t[0]]).cwiseProduct(size);
    const Eigen::Vector2f b = (mesh.texture_coordinates[t[2]] - mesh.texture_coordinates[t[0]]).cwiseProduct(size);
    const float area =
        (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm();
    const float texels = std::abs(a.x() * b.y() - a.y() * b.x());
    densities.push_back(area > 0.0f ? std::sqrt(texels / area) : 0.0f);
  }
  return densities;
}

std::array<float, 256> reflectances(float tint, float tone) {
  std::array<float, 256> values{};
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = std::min(1.0f, tint * std::pow(static_cast<float>(i) / 255.0f, kDisplayGamma * tone));
  return values;
}

float interpolate(const std::array<float, 256>& table, float display) {
  const int floor = std::min(254, static_cast<int>(display));
  const float part = display - static_cast<float>(floor);
  return (1.0f - part) * table[static_cast<size_t>(floor)] + part * table[static_cast<size_t>(floor) + 1];
}

}  // namespace

Appearance::Appearance(std::shared_ptr<const TexturedMesh> mesh, const Finish& finish)
    : mesh_(std::move(mesh)), finish_(finish) {
  if (!mesh_ || mesh_->triangles.empty()) throw std::invalid_argument("scene: a body's mesh has no triangles");
  for (int c = 0; c < 3; ++c) reflectance_[static_cast<size_t>(c)] = reflectances(finish.tint[c], finish.tone);
  if (mesh_->texture.empty() || mesh_->texture_coordinates.empty()) return;
  pyramid_ = std::make_unique<TexturePyramid>(*mesh_);
  texels_per_metre_ = texelDensities(*mesh_);
}

Eigen::Vector3f Appearance::albedo(std::uint32_t triangle, const Eigen::Vector3f& weights, float footprint) const {
  const auto& t = mesh_->triangles[triangle];
  Eigen::Vector3f bgr = Eigen::Vector3f::Zero();
  if (pyramid_) {
    const auto& uv = mesh_->texture_coordinates;
    bgr = pyramid_->sample(weights[0] * uv[t[0]] + weights[1] * uv[t[1]] + weights[2] * uv[t[2]],
                           footprint * texels_per_metre_[triangle]);
  } else if (!mesh_->vertex_colors.empty()) {
    for (int k = 0; k < 3; ++k) {
      const cv::Vec3b& rgb = mesh_->vertex_colors[t[static_cast<size_t>(k)]];
      bgr += weights[k] * Eigen::Vector3f(rgb[2], rgb[1], rgb[0]);
    }
  } else {
    bgr = kUntextured;
  }
  return {interpolate(reflectance_[0], bgr[0]), interpolate(reflectance_[1], bgr[1]),
          interpolate(reflectance_[2], bgr[2])};
}

Eigen::Vector3f Appearance::normal(std::uint32_t triangle, const Eigen::Vector3f& weights,
                                   const Eigen::Vector3f& geometric) const {
  if (mesh_->normals.empty()) return geometric;
  const auto& t = mesh_->triangles[triangle];
  const Eigen::Vector3f sum =
      weights[0] * mesh_->normals[t[0]] + weights[1] * mesh_->normals[t[1]] + weights[2] * mesh_->normals[t[2]];
  return sum.allFinite() && sum.norm() > 0.1f ? Eigen::Vector3f(sum.normalized()) : geometric;
}

Pose lookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, double roll) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d up = std::abs(forward.z()) < 0.999 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  Pose pose = Pose::Identity();
  pose.linear().col(0) = right;
  pose.linear().col(1) = forward.cross(right);
  pose.linear().col(2) = forward;
  pose.translation() = eye;
  pose.rotate(Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()));
  return pose;
}

}  // namespace rgbd_recognition
