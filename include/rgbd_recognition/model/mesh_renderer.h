#pragma once

#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/mesh.h"

namespace rgbd_recognition {

/// A mesh in a scene.
struct MeshInstance {
  std::shared_ptr<const TexturedMesh> mesh;
  Pose camera_from_object = Pose::Identity();
};

/// What an ideal camera sees.
struct RenderedView {
  cv::Mat color;     ///< CV_8UC3 BGR, unlit texture; black where nothing is hit
  cv::Mat depth;     ///< CV_32FC1 metres along the optical axis, 0 where nothing is hit
  cv::Mat normals;   ///< CV_32FC3 camera frame, unit, towards the camera
  cv::Mat instance;  ///< CV_32SC1 index of the instance, -1 where nothing is hit
};

/// Casts rays (Embree) at instances; `samples` x `samples` rays a pixel for colour, one through the centre for the rest.
class MeshRenderer {
 public:
  explicit MeshRenderer(const std::vector<MeshInstance>& instances);
  ~MeshRenderer();
  RenderedView render(const CameraModel& camera, int samples = 1) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbd_recognition
