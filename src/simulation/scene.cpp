#include "simulation/scene.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "meshes/textured_surface.h"

namespace recognition {
namespace {

const float kDisplayGamma = 2.2f;
const Eigen::Vector3f kUntextured(186.0f, 186.0f, 186.0f);

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
  surface_ = std::make_unique<TexturedSurface>(mesh_);
}

Appearance::~Appearance() = default;

Eigen::Vector3f Appearance::albedo(std::uint32_t triangle, const Eigen::Vector3f& weights, float footprint) const {
  const Eigen::Vector3f bgr = surface_->colorAt(triangle, weights, footprint, kUntextured);
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

}  // namespace recognition
