#pragma once

#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {

/// A mesh in a scene.
struct MeshInstance {
  std::shared_ptr<const TexturedMesh> mesh;
  Pose camera_from_object = Pose::Identity();  ///< of the camera at the scene's origin
};

/// What an ideal camera sees.
struct RenderedView {
  cv::Mat color;     ///< CV_8UC3 BGR, unlit texture; black where nothing is hit
  cv::Mat depth;     ///< CV_32FC1 metres along the optical axis, 0 where nothing is hit
  cv::Mat normals;   ///< CV_32FC3 camera frame, unit, towards the camera
  cv::Mat instance;  ///< CV_32SC1 index of the instance, -1 where nothing is hit
};

/// What one ray meets. `distance` counts in lengths of the ray's direction; infinite where nothing is hit.
struct RayHit {
  float distance = 0.0f;
  int instance = -1;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, towards the ray's origin
  Eigen::Vector3f bgr = Eigen::Vector3f::Zero();     ///< 0..255
  bool hit() const { return instance >= 0; }
};

/// Casts rays (Embree) at instances; `samples` x `samples` rays a pixel for colour, one through the centre for the
/// rest. Textures are averaged over what a ray's share of the pixel covers, so one sample is alias-free inside a
/// surface and more smooth the outlines. Both sides of a triangle are seen. Safe to use from several threads.
class MeshRenderer {
 public:
  explicit MeshRenderer(const std::vector<MeshInstance>& instances);
  ~MeshRenderer();

  /// The scene through `camera`, which may be elsewhere than at the scene's origin: `camera_from_scene`. Throws
  /// std::invalid_argument for a camera that does not validate or samples < 1.
  RenderedView render(const CameraModel& camera, int samples = 1,
                      const Pose& camera_from_scene = Pose::Identity()) const;

  /// One ray in the scene's frame; colour is averaged over a square of `texture_width` metres.
  RayHit cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float texture_width) const;

  /// Whether a ray meets anything.
  bool occluded(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
