#pragma once

#include "rgbd_recognition/core/camera.h"
#include "simulation/ray_scene.h"

namespace recognition {

/// What an ideal infrared camera sees of a projector's pattern.
struct StructuredLightView {
  cv::Mat depth;    ///< CV_32FC1 metres along the axis, 0 where nothing is met
  cv::Mat normals;  ///< CV_32FC3 infrared camera's frame, unit, towards the camera
  cv::Mat signal;   ///< CV_32FC1 light that comes back: reflectance * cos(incidence) / z^2, 0 where the projector does
                    ///< not reach
  cv::Mat glare;    ///< CV_32FC1 mirrored light of the projector, 0 to 1
};

/// `world_from_camera` is the infrared camera; the projector is `baseline` metres along its +x axis (negative: to the
/// left).
StructuredLightView renderStructuredLight(const RayScene& scene, const CameraModel& camera,
                                          const Pose& world_from_camera, double baseline);

}  // namespace recognition
