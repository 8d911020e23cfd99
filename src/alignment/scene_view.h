#pragma once

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/segmentation/segmentation.h"

namespace recognition {

/// All that hypotheses of one frame are tested against; computed once a frame. Depth resolution throughout.
struct SceneView {
  cv::Mat depth;            ///< CV_32FC1 metres, 0 invalid
  cv::Mat lab;              ///< CV_32FC3 CIELAB
  cv::Mat clipped;          ///< CV_8UC1, 255 where a colour channel is saturated (>= 250)
  cv::Mat lightness;        ///< CV_32FC1, L of `lab` smoothed as a model's cloud is: what the refinement aligns to
  CameraModel camera;       ///< of `depth`
  int color_per_depth = 1;  ///< k of RgbdFrame: keypoints are in colour pixels
  const Segmentation* segmentation = nullptr;
  const SceneFeatures* features = nullptr;

  /// The two pointers are kept; depth is depthInMetres() of the frame.
  static SceneView make(const RgbdFrame& frame, const cv::Mat& depth, const Segmentation& segmentation,
                        const SceneFeatures& features);
};

/// Where a keypoint (colour pixels) lies in the depth image: colour pixels k u .. k u + k - 1 are depth pixel u.
inline Eigen::Vector2d depthPixel(const Keypoint& keypoint, int color_per_depth) {
  const double k = color_per_depth;
  return {(keypoint.x + 0.5) / k - 0.5, (keypoint.y + 0.5) / k - 0.5};
}

}  // namespace recognition
