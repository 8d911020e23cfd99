#pragma once

#include <memory>
#include <vector>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {

/// The convex hull that stands for a mesh in the physics. Body frame, metres.
struct RigidShape {
  std::vector<Eigen::Vector3d> points;  ///< vertices of the mesh that are extreme in one of some hundred directions
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of mass: that of the surface
};

/// Throws std::invalid_argument for a mesh without triangles.
RigidShape convexShape(const TexturedMesh& mesh);

/// Height of the lowest point of a shape turned by `rotation` about its frame's origin.
double lowestPoint(const RigidShape& shape, const Eigen::Matrix3d& rotation);

/// Bodies that fall, stack and lean until they rest (Bullet). World: z up, metres. Fixed steps on one thread: the same
/// calls give the same poses.
class PhysicsWorld {
 public:
  PhysicsWorld();
  ~PhysicsWorld();

  void addFixedBox(const Eigen::Vector3d& size, const Pose& world_from_box);

  /// Returns the body's index. `friction` as Coulomb's coefficient against a body of the same kind.
  int addBody(const RigidShape& shape, const Pose& world_from_body, double friction = 0.7);

  void run(double seconds);

  /// Runs until nothing moves any more; false if something still does after `max_seconds`.
  bool settle(double max_seconds);

  Pose pose(int body) const;
  Eigen::AlignedBox3d bounds(int body) const;

  /// Depth of the deepest overlap of any two bodies (or body and fixed box), metres, 0 or more.
  double deepestOverlap() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
