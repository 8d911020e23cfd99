#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/extents.h"
#include "segmentation/quadric.h"
#include "rgbd_recognition/segmentation/segmentation.h"
#include "rgbd_recognition/segmentation/segmentation_parameters.h"

namespace recognition {

/// From smooth pixels to patches (Sec. IV-A): connected components, PCA limits of the trained objects, expansion by
/// quadrics.
class PatchBuilder {
 public:
  PatchBuilder(const SegmentationParameters& parameters, const Extents& limits);

  /// Components of `smooth` (CV_8UC1, not 0) become patches in `labels` (CV_32SC1; kUnlabelled elsewhere), in the order
  /// of their first pixels; those of the wrong size are dropped. False if one was too large, as the table with what
  /// stands on it is where edges did not part them: `too_large` (CV_8UC1) is then 255 on all such.
  bool findComponents(const cv::Mat& depth, const cv::Mat& smooth, const CameraModel& camera, cv::Mat* labels,
                      cv::Mat* too_large);

  /// Patches grow over neighbouring pixels that lie on their quadrics, then over what is left beside them up to jumps
  /// (a deviation: outlines, where depth is noisier than any quadric allows, stay in the regions of interest); never
  /// over pixels where `barred` (CV_8UC1) is set.
  void expand(const cv::Mat& inverse, const cv::Mat& barred, cv::Mat* labels);

  /// Pixel counts, boxes and PCA of the patches as they are in `labels` now.
  std::vector<Patch> describe(const cv::Mat& depth, const CameraModel& camera, const cv::Mat& labels) const;

 private:
  /// Breadth first from all patches at once; joins(label, 1/z of the patch's pixel, 1/z of its neighbour, u and v of
  /// the neighbour).
  template <typename Joins>
  void grow(const cv::Mat& inverse, const cv::Mat& barred, cv::Mat* labels, Joins joins);
  bool tooLarge(const Patch& patch) const;  ///< by the sizes of eq. (4)

  const SegmentationParameters parameters_;
  const Extents limits_;
  std::vector<cv::Rect> boxes_;  ///< of the kept components
  std::vector<int> new_labels_;
  std::vector<InverseDepthQuadric> quadrics_;
  std::vector<int> frontier_, next_frontier_;
};

}  // namespace recognition
