#pragma once

#include <memory>

#include "simulation/scene.h"

namespace recognition {

/// What a ray meets. World frame.
struct SurfaceHit {
  int body = -1;  ///< index in Scene::bodies, -1 if nothing was met
  std::uint32_t triangle = 0;
  Eigen::Vector3f weights;  ///< barycentric
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  ///< unit, towards the ray's origin
  float distance = 0.0f;   ///< in lengths of the ray's direction

  bool met() const { return body >= 0; }
};

/// A Scene prepared for ray casting (Embree). Safe for concurrent casts. The Scene must outlive it.
class RayScene {
 public:
  explicit RayScene(const Scene& scene);
  ~RayScene();

  const Scene& scene() const;
  SurfaceHit cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;

  /// The same with no other body in the way; whether it is met.
  bool meetsAlone(int body, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;

  /// Whether anything lies between the points; `offset` metres beside either end do not count.
  bool blocked(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float offset = 1e-3f) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
