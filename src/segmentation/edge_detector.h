#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/segmentation/segmentation_parameters.h"

namespace recognition {

/// Algorithm 1 on all rows, columns, ascending and descending diagonals of an image, in parallel.
class EdgeDetector {
 public:
  explicit EdgeDetector(const SegmentationParameters& parameters);
  ~EdgeDetector();

  /// `range`: CV_32FC1; depth (NoiseModel::kConstant) or inverse depth (kSensor), 0 invalid. `edges` becomes CV_8UC1 of
  /// EdgeType: an edge in any direction counts; a jump in any direction makes a jump, else the more frequent kind of
  /// crease (a tie: convex). Deterministic for any number of threads; not for concurrent use of one detector, which
  /// keeps its memory between calls.
  void detect(const cv::Mat& range, const CameraModel& camera, cv::Mat* edges);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
