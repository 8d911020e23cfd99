#pragma once

#include <vector>

#include "rgbd_recognition/meshes/mesh.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// `count` unit vectors spread evenly over the sphere (Fibonacci lattice).
std::vector<Eigen::Vector3f> sphereDirections(int count);

/// The coloured cloud P, eq. (3), of a mesh: points spread evenly over that part of the surface which can be seen from
/// outside, at most `max_points`, about `spacing` metres apart (more where max_points would not reach); colour averaged
/// over the spacing; normals towards the side that is seen. Same mesh, same cloud.
std::vector<SurfacePoint> sampleSurface(const TexturedMesh& mesh, double spacing, int max_points);

/// Keeps, in their order, each point that has no kept one of the same side of the surface nearer than `distance`.
std::vector<SurfacePoint> thinSurface(const std::vector<SurfacePoint>& points, float distance);

/// The same for surfaces that were measured, whose points scatter along the normal: of a layer of up to `thickness`,
/// one sheet of points is kept, each moved along its normal to the middle of the points about it, which weigh as told.
std::vector<SurfacePoint> thinMeasuredSurface(const std::vector<SurfacePoint>& points,
                                              const std::vector<float>& weights, float distance, float thickness);

}  // namespace recognition
