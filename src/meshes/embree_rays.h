#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include <embree3/rtcore.h>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {

/// The mesh's triangles, moved. To be released by the caller.
inline RTCGeometry makeGeometry(RTCDevice device, const TexturedMesh& mesh, const Pose& pose = Pose::Identity()) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
  if (!vertices || !indices) throw std::runtime_error("Embree has no memory for a mesh");
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    Eigen::Map<Eigen::Vector3f>(vertices + 3 * i) = (pose * mesh.vertices[i].cast<double>()).cast<float>();
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    std::copy(mesh.triangles[i].begin(), mesh.triangles[i].end(), indices + 3 * i);
  rtcCommitGeometry(geometry);
  return geometry;
}

inline RTCRay makeRay(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near, float far) {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = near;
  ray.tfar = far;
  ray.mask = ~0u;
  return ray;
}

/// The first surface that the ray meets; geomID is RTC_INVALID_GEOMETRY_ID where there is none.
inline RTCRayHit firstHit(RTCScene scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray = makeRay(origin, direction, 0.0f, std::numeric_limits<float>::infinity());
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene, &context, &query);
  return query;
}

/// Whether the ray meets anything between `near` and `far`, in lengths of `direction`.
inline bool isBlocked(RTCScene scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                      float near = 0.0f, float far = std::numeric_limits<float>::infinity()) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = makeRay(origin, direction, near, far);
  rtcOccluded1(scene, &context, &ray);
  return ray.tfar < 0.0f;
}

}  // namespace recognition
