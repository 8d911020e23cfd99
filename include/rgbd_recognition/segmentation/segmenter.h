#pragma once

#include <memory>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/extents.h"
#include "rgbd_recognition/core/parameters.h"
#include "rgbd_recognition/segmentation/segmentation.h"

namespace rgbd_recognition {

/// Modes of Table II by their names.
enum class SegmentationMode { kSimpleLinear, kSimpleQuadratic, kLsAicc, kLsMixed };

/// Parameters of Sec. IV.
struct SegmentationParameters {
  SegmentationMode mode = SegmentationMode::kLsMixed;

  ParameterList list();
  void validate() const;
};

/// Sec. IV: depth image -> smooth patches, the regions of interest.
class Segmenter {
 public:
  /// `limits`: extentLimits() of the trained objects; all zero switches the size filters off.
  Segmenter(const SegmentationParameters& parameters, const Extents& limits);
  ~Segmenter();

  /// `depth`: CV_32FC1 metres, 0 invalid. Deterministic for any number of threads. Not for concurrent use of one Segmenter: it keeps its
  /// buffers between frames.
  Segmentation segment(const cv::Mat& depth, const CameraModel& depth_camera);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbd_recognition
