#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/verification/color_transform.h"
#include "rgbd_recognition/verification/depth_buffer.h"
#include "rgbd_recognition/verification/scene_view.h"
#include "rgbd_recognition/verification/verification_parameters.h"

namespace rgbd_recognition {

/// The measures of eq. (12)-(17), and how much of the model is seen.
struct ConsistencyScores {
  double s_d = 0.0;         ///< eq. (12)
  double s_c = 0.0;         ///< eq. (13)
  double s_o = 0.0;         ///< eq. (14)
  double total = 0.0;       ///< left side of eq. (17)
  int projected = 0;        ///< |M_j|, pixels
  double visible = 0.0;     ///< share of M_j that is not hidden by something nearer, 0..1
  double free_space = 0.0;  ///< share of M_j through which the scene is seen, 0..1
  int best_segment = 0;     ///< label of S*, 0 for none
};

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

/// 1_c of eq. (16), CV_8UC1, for the model's colours as `light` turns them.
cv::Mat testColor(const ReprojectedModel& reprojected, const PreparedModel& model, const ColorTransform& light,
                  const SceneView& scene, const VerificationParameters& parameters);

/// Eq. (12)-(14) and the left side of eq. (17). All zero for an empty M_j.
ConsistencyScores consistencyScores(const PixelConsistency& pixels, const cv::Rect& box,
                                    const Segmentation& segmentation, double w_c);

}  // namespace rgbd_recognition
