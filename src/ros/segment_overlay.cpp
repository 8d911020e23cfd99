#include "ros/segment_overlay.h"

#include "rgbd_recognition/annotation.h"

namespace recognition {
namespace {

cv::Vec3b edgeColor(std::uint8_t type) {
  switch (static_cast<EdgeType>(type)) {
    case EdgeType::kJump:
      return {0, 0, 255};
    case EdgeType::kConvexCrease:
      return {0, 255, 0};
    default:
      return {255, 0, 0};
  }
}

}  // namespace

cv::Mat segmentOverlay(const RgbdFrame& frame, const Segmentation& segmentation) {
  cv::Mat overlay = bgrCopy(frame);
  const int k = frame.colorPerDepthPixel();
  for (int v = 0; v < segmentation.labels.rows * k; ++v) {
    const int* labels = segmentation.labels.ptr<int>(v / k);
    const std::uint8_t* edges = segmentation.edges.ptr<std::uint8_t>(v / k);
    cv::Vec3b* pixels = overlay.ptr<cv::Vec3b>(v);
    for (int u = 0; u < segmentation.labels.cols * k; ++u) {
      if (edges[u / k]) {
        pixels[u] = edgeColor(edges[u / k]);
      } else if (labels[u / k] > 0) {
        const cv::Scalar tint = objectColor(labels[u / k]);
        for (int c = 0; c < 3; ++c)
          pixels[u][c] = cv::saturate_cast<std::uint8_t>(0.45 * pixels[u][c] + 0.55 * tint[c]);
      } else if (labels[u / k] == kLargePlane) {
        pixels[u] *= 0.4;
      }
    }
  }
  return overlay;
}

}  // namespace recognition
