#pragma once

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/features/feature_parameters.h"
#include "rgbd_recognition/features/feature_types.h"

namespace recognition {

/// A plane as a depth image sees it about a place: inverse depth is linear in u and v on it.
struct DepthPlane {
  float z = 0.0f;                                  ///< metres, at the place; 0: there is none
  float inverse_by_u = 0.0f, inverse_by_v = 0.0f;  ///< change of 1 / z, a pixel
};

/// The surface that owns the depth-image place (u, v), if one is near enough.
///
/// The valid depths within `radius` pixels, sorted, fall apart into surfaces wherever two neighbours differ by more
/// than a jump (or by what noise explains at that range, depthSigma()). The nearest surface with a fair share of the
/// Gaussian weight around (u, v) owns the keypoint: on an outline that is the object, not what is behind it. Its depth
/// is read off a plane (inverse depth is linear in u and v on a plane) fitted to that surface alone and never leaves
/// the surface's own range, so it lies on one side of every jump; holes up to `max_hole` are bridged by the same plane.
DepthPlane surfaceAt(const cv::Mat& depth, float u, float v, int radius, const LiftingParameters& parameters);

/// Lifts features to 3D from the depth under them (depth CV_32FC1 metres, 0 invalid; `color_per_depth` = k of
/// RgbdFrame), eq. (2). Throws std::invalid_argument for any other type of depth.
SceneFeatures liftFeatures(const ImageFeatures& features, const cv::Mat& depth, const CameraModel& depth_camera,
                           int color_per_depth, const LiftingParameters& parameters = {});

}  // namespace recognition
