#pragma once

#include <memory>

#include "benchmarks/segmentation_quality.h"

namespace recognition {

/// What users would pick from PCL: normals from integral images, organised planes (refined), organised connected
/// components of the rest. Settings are the best found on the 16 labelled clouds that --mosd is meant for; planes over
/// 20,000 pixels are removed.
class PclSegmentation {
 public:
  /// Makes the organised cloud, which is not part of segment()'s time.
  explicit PclSegmentation(const DepthFrame& frame);
  ~PclSegmentation();

  /// CV_32SC1: >= 1 patches, kLargePlane, kUnlabelled.
  cv::Mat segment() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
