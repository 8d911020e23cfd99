#pragma once

#include "rgbd_recognition/core/camera.h"
#include "simulation/ray_scene.h"

namespace recognition {

/// How much of a body is seen, in pixels of the camera asked about (BOP's definitions).
struct BodyVisibility {
  int all = 0;  ///< pixels of the silhouette were the body alone, those outside the image included
  int visible = 0;
  cv::Rect box_all;      ///< of the silhouette; may leave the image
  cv::Rect box_visible;  ///< empty if nothing is seen

  double fraction() const { return all > 0 ? static_cast<double>(visible) / all : 0.0; }
};

/// CV_32SC1: index of the body that each pixel's centre sees, -1 for none.
cv::Mat renderBodies(const RayScene& scene, const CameraModel& camera);

/// `bodies` is what renderBodies() gave for the same scene and camera. A body that reaches behind the camera counts as
/// invisible.
BodyVisibility measureVisibility(const RayScene& scene, const CameraModel& camera, const cv::Mat& bodies, int body);

}  // namespace recognition
