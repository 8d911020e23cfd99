#include "simulation/scene.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "meshes/textured_surface.h"

namespace recognition {
namespace {

const float kDisplayGamma = 2.2f;
constexpr float kPaper = 0.75f;  // reflectance of bleached paper
const Eigen::Vector3f kUntextured(186.0f, 186.0f, 186.0f);

std::array<float, 256> reflectances(float tint, const Finish& finish) {
  std::array<float, 256> values{};
  for (size_t i = 0; i < values.size(); ++i) {
    const float fresh = tint * std::pow(static_cast<float>(i) / 255.0f, kDisplayGamma * finish.tone);
    values[i] = std::min(1.0f, finish.fade * kPaper + (1.0f - finish.fade) * fresh);
  }
  return values;
}

std::array<std::array<float, 256>, 3> reflectances(const Finish& finish) {
  return {reflectances(finish.tint[0], finish), reflectances(finish.tint[1], finish),
          reflectances(finish.tint[2], finish)};
}

float interpolate(const std::array<float, 256>& table, float display) {
  const int floor = std::min(254, static_cast<int>(display));
  const float part = display - static_cast<float>(floor);
  return (1.0f - part) * table[static_cast<size_t>(floor)] + part * table[static_cast<size_t>(floor) + 1];
}

}  // namespace

BodyAppearance::BodyAppearance(std::shared_ptr<const TexturedMesh> mesh, const Finish& finish)
    : mesh_(std::move(mesh)), finish_(finish) {
  if (!mesh_ || mesh_->triangles.empty()) throw std::invalid_argument("scene: a body's mesh has no triangles");
  reflectance_ = reflectances(finish);
  surface_ = std::make_shared<TexturedSurface>(mesh_);
}

BodyAppearance::BodyAppearance(const BodyAppearance& other, const Finish& finish)
    : mesh_(other.mesh_), finish_(finish), reflectance_(reflectances(finish)), surface_(other.surface_) {}

BodyAppearance::~BodyAppearance() = default;

Eigen::Vector3f BodyAppearance::albedo(std::uint32_t triangle, const Eigen::Vector3f& weights, float footprint) const {
  const Eigen::Vector3f bgr = surface_->colorAt(triangle, weights, footprint, kUntextured);
  const Eigen::Vector3f full(interpolate(reflectance_[0], bgr[0]), interpolate(reflectance_[1], bgr[1]),
                             interpolate(reflectance_[2], bgr[2]));
  if (finish_.chroma == 1.0f) return full;
  const Eigen::Vector3f gray = Eigen::Vector3f::Constant(full.dot(Eigen::Vector3f(0.114f, 0.587f, 0.299f)));
  return (gray + finish_.chroma * (full - gray)).cwiseMax(0.0f).cwiseMin(1.0f);
}

Eigen::Vector3f BodyAppearance::normal(std::uint32_t triangle, const Eigen::Vector3f& weights,
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
