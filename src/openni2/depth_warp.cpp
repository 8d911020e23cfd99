#include "openni2/depth_warp.h"

#include <cmath>

namespace recognition::openni2 {

cv::Mat warpDepth(const cv::Mat& depth_mm, const CameraModel& from, const CameraModel& to, double shift_x) {
  cv::Mat warped(to.height, to.width, CV_16UC1, cv::Scalar(0));
  const double scale_x = to.fx / from.fx;
  const double scale_y = to.fy / from.fy;
  for (int v = 0; v < depth_mm.rows; ++v) {
    const int row = static_cast<int>(std::lround((v - from.cy) * scale_y + to.cy));
    if (row < 0 || row >= to.height) continue;
    const auto* source = depth_mm.ptr<uint16_t>(v);
    auto* target = warped.ptr<uint16_t>(row);
    for (int u = 0; u < depth_mm.cols; ++u) {
      if (source[u] == 0) continue;
      const double z = 1e-3 * source[u];
      const int column = static_cast<int>(std::lround((u - from.cx) * scale_x + to.fx * shift_x / z + to.cx));
      if (column < 0 || column >= to.width) continue;
      if (target[column] == 0 || source[u] < target[column]) target[column] = source[u];
    }
  }
  return warped;
}

}  // namespace recognition::openni2
