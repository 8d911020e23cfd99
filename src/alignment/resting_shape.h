#pragma once

#include <vector>

#include <Eigen/Core>

namespace recognition {

/// A way for an object to lie on a plane; object frame.
struct RestingPose {
  Eigen::Vector3f down = Eigen::Vector3f::Zero();  ///< unit: out of the object into the plane
  float reach = 0.0f;                              ///< of the object along `down` from its origin, metres
};

/// Poses in which the centre (taken for that of mass) of a rigid body lies lowest, compared with poses turned a little:
/// of a can two upright ones and some of the many on its side. The lowest first, at most 24.
std::vector<RestingPose> restingPoses(const std::vector<Eigen::Vector3f>& positions, const Eigen::Vector3f& centre);

/// The surface by the direction in which it looks.
class FaceTable {
 public:
  struct Face {
    Eigen::Vector3f centroid = Eigen::Vector3f::Zero();  ///< object frame, metres
    float share = 0.0f;                                  ///< of all points
    Eigen::Vector3f lab = Eigen::Vector3f::Zero();       ///< mean colour, CIELAB
  };

  FaceTable() = default;
  /// Of points whose normals lie within `angle` degrees of a direction.
  FaceTable(const std::vector<Eigen::Vector3f>& positions, const std::vector<Eigen::Vector3f>& normals,
            const std::vector<Eigen::Vector3f>& lab, double angle);

  /// What looks along a unit direction, which is rounded by some degrees.
  const Face& facing(const Eigen::Vector3f& direction) const;

 private:
  std::vector<Face> faces_;  ///< by cell of an octahedron's unfolded faces
};

}  // namespace recognition
