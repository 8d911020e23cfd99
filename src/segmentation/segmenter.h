#pragma once

#include <memory>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/extents.h"
#include "rgbd_recognition/segmentation/segmentation.h"
#include "rgbd_recognition/segmentation/segmentation_parameters.h"

namespace recognition {

/// Wall time of the parts of Segmenter::segment(), seconds.
struct SegmentationTimes {
  double edges = 0.0;       ///< Algorithm 1 on all scan-lines (what Table II times)
  double planes = 0.0;      ///< distance transform, large planes
  double components = 0.0;  ///< morphology, connected components, PCA limits
  double expansion = 0.0;   ///< quadrics, expansion, final PCA
};

/// Sec. IV: depth image -> smooth patches, the regions of interest.
class Segmenter {
 public:
  /// `limits`: extentLimits() of the trained objects; all zero switches the size filters off (large planes stay, too).
  /// Throws std::invalid_argument that names a parameter out of range.
  Segmenter(const SegmentationParameters& parameters, const Extents& limits);
  ~Segmenter();

  /// `depth`: CV_32FC1 metres, 0 invalid, of the camera's size; throws std::invalid_argument otherwise.
  ///
  /// Deterministic for any number of threads. Not for concurrent use of one Segmenter: it keeps its buffers between
  /// frames. The images in the result are the caller's as long as any copy of their cv::Mat headers lives; after that
  /// their memory serves a later frame.
  Segmentation segment(const cv::Mat& depth, const CameraModel& depth_camera);

  /// Of the last call.
  const SegmentationTimes& times() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
