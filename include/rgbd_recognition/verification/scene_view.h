#pragma once

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/segmentation/segmentation.h"

namespace rgbd_recognition {

/// All that hypotheses of one frame are tested against; computed once a frame. Depth resolution throughout.
struct SceneView {
  cv::Mat depth;               ///< CV_32FC1 metres, 0 invalid
  cv::Mat lab;                 ///< CV_32FC3 CIELAB
  cv::Mat clipped;             ///< CV_8UC1, 255 where a colour channel is saturated (>= 250)
  CameraModel camera;          ///< of `depth`
  const Segmentation* segmentation = nullptr;
  const SceneFeatures* features = nullptr;

  /// The two pointers are kept; depth is depthInMetres() of the frame.
  static SceneView make(const RgbdFrame& frame, const cv::Mat& depth, const Segmentation& segmentation, const SceneFeatures& features);
};

}  // namespace rgbd_recognition
