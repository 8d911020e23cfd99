#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "alignment/illumination.h"
#include "alignment/depth_buffer.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/verification/verification_parameters.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"
#include "alignment/prepared_model.h"

namespace recognition {

/// What the frame's depth says about a pixel of M_j.
enum class PixelState : std::uint8_t {
  kOutside = 0,  ///< not in M_j
  kConsistent,   ///< 1_d of eq. (15) holds
  kOccluded,     ///< something nearer is in front: says nothing about the hypothesis
  kFreeSpace,    ///< the scene is seen through the model
  kUnknown       ///< no depth: a hole, says nothing either
};

/// Per-pixel answers over ReprojectedModel::box.
struct PixelConsistency {
  cv::Mat state;     ///< CV_8UC1 PixelState
  cv::Mat color_ok;  ///< CV_8UC1, 1_c of eq. (16): 1 or 0
};

/// Largest range difference that is consistent at depth z: epsilon_d and the sensor's noise there, metres.
double depthTolerance(const VerificationParameters& parameters, double z);

/// 1_d of eq. (15) with its reasons: PixelState of each pixel, CV_8UC1.
cv::Mat testDepth(const ReprojectedModel& reprojected, const SceneView& scene,
                  const VerificationParameters& parameters);

/// 1_c of eq. (16), CV_8UC1, for the model's colours as `illumination` turns them.
cv::Mat testColor(const ReprojectedModel& reprojected, const ModelCloud& model, const ColorTransform& illumination,
                  const SceneView& scene, const VerificationParameters& parameters);

/// Eq. (12)-(14) and the left side of eq. (17). All zero for an empty M_j.
ConsistencyScores consistencyScores(const PixelConsistency& pixels, const cv::Rect& box,
                                    const Segmentation& segmentation, double w_c);

}  // namespace recognition
