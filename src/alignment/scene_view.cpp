#include "alignment/scene_view.h"

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr double kSaturated = 250.0;
constexpr double kSmoothing = 1.0;  // pixels

/// 255 where any channel of any of the k x k colour pixels is saturated.
cv::Mat clippedMask(const RgbdFrame& frame, cv::Size depth_size) {
  const int k = frame.colorPerDepthPixel();
  const cv::Mat covered = frame.color(cv::Rect(0, 0, depth_size.width * k, depth_size.height * k));
  cv::Mat saturated;
  cv::inRange(covered, cv::Scalar::all(0), cv::Scalar::all(kSaturated - 1), saturated);
  cv::bitwise_not(saturated, saturated);
  if (k > 1) {
    cv::dilate(saturated, saturated, cv::Mat::ones(k, k, CV_8UC1), cv::Point(0, 0));
    cv::resize(saturated, saturated, depth_size, 0, 0, cv::INTER_NEAREST);
  }
  return saturated;
}

}  // namespace

SceneView SceneView::make(const RgbdFrame& frame, const cv::Mat& depth, const Segmentation& segmentation,
                          const SceneFeatures& features) {
  requireSameSize(segmentation, depth);
  SceneView scene;
  scene.depth = depth;
  scene.color_per_depth = frame.colorPerDepthPixel();
  scene.lab = toCielab(frame.color, frame.color_order, scene.color_per_depth, depth.size());
  cv::extractChannel(scene.lab, scene.lightness, 0);
  cv::GaussianBlur(scene.lightness, scene.lightness, {0, 0}, kSmoothing);
  scene.clipped = clippedMask(frame, depth.size());
  scene.camera = frame.depthCamera();
  scene.segmentation = &segmentation;
  scene.features = &features;
  return scene;
}

}  // namespace recognition
