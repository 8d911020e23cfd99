#include "search/explained_segments.h"

#include <vector>

namespace recognition {
namespace {

constexpr double kSegmentShare = 0.5;  // of a segment that a detection must explain to take it away

std::set<int> segmentsOf(const TestedHypothesis& tested, const Segmentation& segmentation) {
  const cv::Rect& box = tested.reprojected.box;
  std::vector<int> consistent(segmentation.patches.size() + 1, 0);
  for (int v = 0; v < box.height; ++v) {
    for (int u = 0; u < box.width; ++u) {
      const int label = segmentation.labels.at<int>(v + box.y, u + box.x);
      if (label > 0 && tested.pixels.state.at<PixelState>(v, u) == PixelState::kConsistent &&
          tested.pixels.color_ok.at<std::uint8_t>(v, u))
        ++consistent[static_cast<size_t>(label)];
    }
  }
  std::set<int> labels;
  if (tested.verified.scores.best_segment > 0) labels.insert(tested.verified.scores.best_segment);
  for (const Patch& patch : segmentation.patches)
    if (consistent[static_cast<size_t>(patch.label)] > kSegmentShare * patch.pixels) labels.insert(patch.label);
  return labels;
}

}  // namespace

std::set<int> explainedSegments(const std::vector<TestedHypothesis>& accepted, const Segmentation& segmentation) {
  std::set<int> labels;
  for (const TestedHypothesis& one : accepted) labels.merge(segmentsOf(one, segmentation));
  return labels;
}

Segmentation without(const Segmentation& segmentation, const std::set<int>& labels) {
  Segmentation left = segmentation;
  left.labels = segmentation.labels.clone();
  left.labels.forEach<int>([&](int& label, const int*) {
    if (label > 0 && labels.count(label)) label = kUnlabelled;
  });
  return left;
}

cv::Mat maskOf(const Segmentation& segmentation, const std::set<int>& labels) {
  cv::Mat mask(segmentation.labels.size(), CV_8UC1, cv::Scalar(0));
  for (const int label : labels) mask.setTo(255, segmentation.labels == label);
  return mask;
}

}  // namespace recognition
