#include "features/active_features.h"

namespace recognition {

std::vector<std::uint8_t> activeFeatures(const SceneFeatures& features, const cv::Mat& explained, int color_per_depth) {
  std::vector<std::uint8_t> active(features.image.keypoints.size(), 1);
  for (size_t i = 0; i < active.size(); ++i) {
    const Keypoint& keypoint = features.image.keypoints[i];
    const int u = cvRound(keypoint.x) / color_per_depth;
    const int v = cvRound(keypoint.y) / color_per_depth;
    if (u >= 0 && v >= 0 && u < explained.cols && v < explained.rows) active[i] = explained.at<std::uint8_t>(v, u) == 0;
  }
  return active;
}

}  // namespace recognition
