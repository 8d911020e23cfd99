#pragma once

#include <array>
#include <memory>
#include <vector>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {

class TexturedSurface;

/// How a surface reflects, beside its texture.
struct Finish {
  float specular = 0.03f;        ///< weight of the mirror lobe, 0 to 1
  float shininess = 20.0f;       ///< exponent of that lobe
  float infrared_floor = 0.25f;  ///< reflectance that black print keeps in the infrared, 0 to 1

  /// The thing beside its scan: a scanned texture holds the scanner's light and colours, and the thing has aged since.
  /// Reflectance = fade * paper + (1 - fade) * tint * texture ^ tone (linear light), its chroma times `chroma`.
  Eigen::Vector3f tint = Eigen::Vector3f::Ones();  ///< BGR
  float tone = 1.0f;
  float fade = 0.0f;    ///< share of bleached paper, 0 to 1
  float chroma = 1.0f;  ///< 0: grey
};

/// A mesh made ready to be lit. Immutable; shared by instances and scenes.
class BodyAppearance {
 public:
  /// Throws std::invalid_argument for a mesh without triangles.
  BodyAppearance(std::shared_ptr<const TexturedMesh> mesh, const Finish& finish);
  /// The same mesh with another finish; the texture is shared.
  BodyAppearance(const BodyAppearance& other, const Finish& finish);
  ~BodyAppearance();

  const TexturedMesh& mesh() const { return *mesh_; }
  const Finish& finish() const { return finish_; }

  /// Reflectance (linear light, BGR, 0 to 1) at barycentric `weights` of a triangle, over a patch `footprint` metres
  /// wide.
  Eigen::Vector3f albedo(std::uint32_t triangle, const Eigen::Vector3f& weights, float footprint) const;

  /// Interpolated vertex normal, or `geometric` where the mesh has none.
  Eigen::Vector3f normal(std::uint32_t triangle, const Eigen::Vector3f& weights,
                         const Eigen::Vector3f& geometric) const;

 private:
  std::shared_ptr<const TexturedMesh> mesh_;
  Finish finish_;
  std::array<std::array<float, 256>, 3> reflectance_;  ///< by channel (BGR) and texture value
  std::shared_ptr<const TexturedSurface> surface_;
};

/// A spherical lamp.
struct Lamp {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< world, metres
  float radius = 0.1f;                                 ///< metres: sets how soft shadows are
  Eigen::Vector3f power = Eigen::Vector3f::Ones();     ///< BGR klx at 1 m
};

/// Something in the scene. `object_id` is that of the model, 0 for furniture and clutter.
struct SceneBody {
  std::shared_ptr<const BodyAppearance> appearance;
  Pose world_from_body = Pose::Identity();
  int object_id = 0;
};

/// All that the sensors look at. World frame: z up, metres; the table top is z = 0.
struct Scene {
  std::vector<SceneBody> bodies;
  std::vector<Lamp> lamps;
  Eigen::Vector3f ambient_above = Eigen::Vector3f::Constant(0.3f);  ///< BGR klx that come evenly from above
  Eigen::Vector3f ambient_below = Eigen::Vector3f::Constant(0.1f);
  Pose world_from_camera = Pose::Identity();  ///< optical frame of the colour camera
};

/// Optical frame of a camera at `eye` that looks at `target`, turned by `roll` radians about its axis; world z is up.
Pose lookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, double roll = 0.0);

}  // namespace recognition
