#include "simulation/lit_renderer.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace recognition {
namespace {

constexpr int kPattern = 4;      // interleaved 4 x 4 directions
constexpr size_t kMaxLamps = 7;  // bits of a mask, the eighth is the open sky
constexpr int kSkyBit = 7;
constexpr float kOcclusionRange = 0.35f;  // metres: farther things do not darken the ambient light
constexpr float kSameNormal = 0.9f;
const float kCircle = 2.0f * std::acos(-1.0f);

struct Pixel {
  int body = -1;
  float footprint = 0.0f;
  Eigen::Vector3f position, normal, towards_camera;
  Eigen::Vector3f albedo = Eigen::Vector3f::Zero();  // mean over the samples of this surface
  Eigen::Vector3f beside = Eigen::Vector3f::Zero();  // light from other surfaces in the pixel, by their share
  float share = 0.0f;                                // of samples on this surface
  std::uint8_t open = 0;                             // bit i: lamp i is seen
};

// Point i of 16 on the unit disc, even by area (Vogel's spiral), turned by `turn` of a circle.
Eigen::Vector2f discPoint(int i, float turn) {
  const float angle = 2.39996323f * static_cast<float>(i) + kCircle * turn;
  const float radius = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(kPattern * kPattern));
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

std::array<Eigen::Vector3f, 2> tangents(const Eigen::Vector3f& normal) {
  const Eigen::Vector3f other = std::abs(normal.x()) < 0.7f ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitY();
  const Eigen::Vector3f first = normal.cross(other).normalized();
  return {first, normal.cross(first)};
}

class Renderer {
 public:
  Renderer(const RayScene& rays, const CameraModel& camera, int samples)
      : rays_(rays),
        scene_(rays.scene()),
        camera_(camera),
        samples_(samples),
        pixels_(static_cast<size_t>(camera.width * camera.height)) {
    const Eigen::Isometry3f pose = scene_.world_from_camera.cast<float>();
    rotation_ = pose.linear();
    eye_ = pose.translation();
  }

  cv::Mat render() {
    cv::Mat radiance(camera_.height, camera_.width, CV_32FC3);
    forRows([this](int v) { castRow(v); });
    forRows([this, &radiance](int v) { shadeRow(v, radiance.ptr<cv::Vec3f>(v)); });
    return radiance;
  }

 private:
  template <typename Work>
  void forRows(const Work& work) const {
    cv::parallel_for_(cv::Range(0, camera_.height), [&work](const cv::Range& rows) {
      for (int v = rows.start; v < rows.end; ++v) work(v);
    });
  }

  Pixel& at(int u, int v) { return pixels_[static_cast<size_t>(v * camera_.width + u)]; }

  void castRow(int v) {
    for (int u = 0; u < camera_.width; ++u) {
      Pixel& pixel = at(u, v);
      const int pattern = u % kPattern + kPattern * (v % kPattern);
      for (int s = 0; s < samples_ * samples_; ++s) addSample(pixel, u, v, s, pattern);
      if (pixel.share > 0.0f) pixel.albedo /= pixel.share;
      const float count = static_cast<float>(samples_ * samples_);
      pixel.share /= count;
      pixel.beside /= count;
      if (pixel.body >= 0) pixel.open = openMask(pixel, pattern);
    }
  }

  void addSample(Pixel& pixel, int u, int v, int s, int pattern) const {
    const double du = (s % samples_ + 0.5) / samples_ - 0.5;
    const double dv = (s / samples_ + 0.5) / samples_ - 0.5;
    const Eigen::Vector3f direction = rotation_ * camera_.unproject(u + du, v + dv, 1.0).cast<float>();
    const SurfaceHit point = rays_.cast(eye_, direction);
    if (!point.met()) {
      pixel.beside += scene_.ambient_above;
      return;
    }
    const float footprint = point.distance / static_cast<float>(camera_.fx * samples_);
    const Eigen::Vector3f albedo = body(point.body).albedo(point.triangle, point.weights, footprint);
    const bool first = pixel.body < 0;
    if (!first && (pixel.body != point.body || pixel.normal.dot(point.normal) < kSameNormal)) {
      Pixel other = makePixel(point, direction);
      other.albedo = albedo;
      pixel.beside += shade(other, maskWeights(openMask(other, pattern)));
      return;
    }
    if (first) {
      const Eigen::Vector3f beside = pixel.beside;
      pixel = makePixel(point, direction);
      pixel.beside = beside;
    }
    pixel.albedo += albedo;
    pixel.share += 1.0f;
  }

  static Pixel makePixel(const SurfaceHit& point, const Eigen::Vector3f& direction) {
    Pixel pixel;
    pixel.body = point.body;
    pixel.position = point.position;
    pixel.normal = point.normal;
    pixel.towards_camera = -direction.normalized();
    return pixel;
  }

  std::uint8_t openMask(const Pixel& pixel, int pattern) const {
    std::uint8_t mask = 0;
    const Eigen::Vector3f from = pixel.position + 5e-4f * pixel.normal;
    for (size_t i = 0; i < scene_.lamps.size(); ++i) {
      const Lamp& lamp = scene_.lamps[i];
      const Eigen::Vector3f towards = lamp.position - from;
      if (towards.dot(pixel.normal) <= 0.0f) continue;
      const auto axes = tangents(towards.normalized());
      const Eigen::Vector2f disc = lamp.radius * discPoint(pattern, 0.37f * static_cast<float>(i));
      if (!rays_.blocked(from, lamp.position + disc.x() * axes[0] + disc.y() * axes[1]))
        mask |= static_cast<std::uint8_t>(1u << i);
    }
    const auto axes = tangents(pixel.normal);
    const Eigen::Vector2f disc = discPoint(pattern, 0.11f);
    const Eigen::Vector3f out =
        disc.x() * axes[0] + disc.y() * axes[1] + std::sqrt(1.0f - disc.squaredNorm()) * pixel.normal;
    if (!rays_.blocked(from, from + kOcclusionRange * out)) mask |= static_cast<std::uint8_t>(1u << kSkyBit);
    return mask;
  }

  static std::array<float, 8> maskWeights(std::uint8_t mask) {
    std::array<float, 8> weights{};
    for (size_t i = 0; i < weights.size(); ++i) weights[i] = static_cast<float>((mask >> i) & 1u);
    return weights;
  }

  // Mean of the masks in the 4 x 4 neighbourhood on the same surface.
  std::array<float, 8> openWeights(int u, int v) {
    std::array<float, 8> weights{};
    const Pixel& pixel = at(u, v);
    float count = 0.0f;
    for (int y = std::max(0, v - 1); y <= std::min(camera_.height - 1, v + 2); ++y)
      for (int x = std::max(0, u - 1); x <= std::min(camera_.width - 1, u + 2); ++x) {
        const Pixel& other = at(x, y);
        if (other.body != pixel.body || other.normal.dot(pixel.normal) < kSameNormal) continue;
        for (size_t i = 0; i < weights.size(); ++i) weights[i] += static_cast<float>((other.open >> i) & 1u);
        count += 1.0f;
      }
    for (float& weight : weights) weight /= count;
    return weights;
  }

  void shadeRow(int v, cv::Vec3f* row) {
    for (int u = 0; u < camera_.width; ++u) {
      const Pixel& pixel = at(u, v);
      Eigen::Vector3f light = pixel.beside;
      if (pixel.body >= 0) light += pixel.share * shade(pixel, openWeights(u, v));
      row[u] = {light[0], light[1], light[2]};
    }
  }

  Eigen::Vector3f shade(const Pixel& pixel, const std::array<float, 8>& open) const {
    const Finish& finish = body(pixel.body).finish();
    const float up = 0.5f + 0.5f * pixel.normal.z();
    Eigen::Vector3f diffuse =
        (up * scene_.ambient_above + (1.0f - up) * scene_.ambient_below) * (0.25f + 0.75f * open[kSkyBit]);
    Eigen::Vector3f mirrored = Eigen::Vector3f::Zero();
    for (size_t i = 0; i < scene_.lamps.size(); ++i) {
      const Eigen::Vector3f towards = scene_.lamps[i].position - pixel.position;
      const float distance = towards.norm();
      const float cosine = pixel.normal.dot(towards) / distance;
      if (cosine <= 0.0f || open[i] <= 0.0f) continue;
      const Eigen::Vector3f arriving = scene_.lamps[i].power * (open[i] / (distance * distance));
      diffuse += cosine * arriving;
      const float half = std::max(0.0f, pixel.normal.dot((towards / distance + pixel.towards_camera).normalized()));
      mirrored += std::pow(half, finish.shininess) * (finish.shininess + 8.0f) / 8.0f * cosine * arriving;
    }
    return (1.0f - finish.specular) * pixel.albedo.cwiseProduct(diffuse) + finish.specular * mirrored;
  }

  const BodyAppearance& body(int index) const { return *scene_.bodies[static_cast<size_t>(index)].appearance; }

  const RayScene& rays_;
  const Scene& scene_;
  const CameraModel& camera_;
  int samples_;
  std::vector<Pixel> pixels_;
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f eye_;
};

}  // namespace

cv::Mat renderRadiance(const RayScene& scene, const CameraModel& camera, int samples) {
  camera.validate();
  if (samples < 1) throw std::invalid_argument("samples is " + std::to_string(samples) + ": must be 1 or more");
  if (scene.scene().lamps.size() > kMaxLamps)
    throw std::invalid_argument("scene: " + std::to_string(scene.scene().lamps.size()) + " lamps, at most " +
                                std::to_string(kMaxLamps));
  return Renderer(scene, camera, samples).render();
}

}  // namespace recognition
