#pragma once

#include <memory>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_parameters.h"
#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/segmentation/segmentation.h"

namespace recognition {

/// Detects keypoints and computes their descriptors. Immutable after construction, safe to use from several threads.
class FeatureExtractor {
 public:
  virtual ~FeatureExtractor() = default;

  /// `gray` CV_8UC1; `mask` CV_8UC1 of the same size (0: no keypoints there) or empty for all. Deterministic for any
  /// number of threads. Throws std::invalid_argument for wrong types or sizes.
  virtual ImageFeatures extract(const cv::Mat& gray, const cv::Mat& mask) const = 0;
};

/// The extractor of `parameters.descriptor`. Throws std::invalid_argument for parameters out of range.
std::unique_ptr<FeatureExtractor> makeFeatureExtractor(const FeatureParameters& parameters);

/// The whole stage of Sec. V: global mask from the regions of interest, keypoints and descriptors in it, lifted to 3D.
SceneFeatures extractSceneFeatures(const FeatureExtractor& extractor, const FeatureParameters& parameters,
                                   const RgbdFrame& frame, const cv::Mat& depth, const Segmentation& segmentation);

}  // namespace recognition
