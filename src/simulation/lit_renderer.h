#pragma once

#include "rgbd_recognition/core/camera.h"
#include "simulation/ray_scene.h"

namespace recognition {

/// What an ideal colour camera measures of a lit scene: direct light of all lamps with soft shadows, diffuse and
/// specular, and ambient light with occlusion. No inter-reflection.
///
/// Each pixel averages `samples` x `samples` rays; lamps and ambient occlusion are sampled by one ray a pixel in a 4 x
/// 4 pattern of directions and averaged over neighbours on the same surface (interleaved sampling, Keller and Heidrich,
/// EGWR 2001). Returns CV_32FC3, BGR, linear in light. Same scene, same bits, for any number of threads.
cv::Mat renderRadiance(const RayScene& scene, const CameraModel& camera, int samples = 2);

}  // namespace recognition
