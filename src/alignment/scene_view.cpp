#include "alignment/scene_view.h"

#include <algorithm>
#include <numeric>

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

/// Every second pixel of depth, the mean of colour: what the coarse level of the test looks at.
std::shared_ptr<const SceneView> halved(const SceneView& scene) {
  auto half = std::make_shared<SceneView>();
  const cv::Size size(scene.depth.cols / 2, scene.depth.rows / 2);
  cv::resize(scene.depth, half->depth, size, 0, 0, cv::INTER_NEAREST);
  cv::resize(scene.lab, half->lab, size, 0, 0, cv::INTER_AREA);
  cv::resize(scene.clipped, half->clipped, size, 0, 0, cv::INTER_NEAREST);
  half->camera = scene.camera.scaled(0.5);
  half->camera.width = size.width;
  half->camera.height = size.height;
  half->segmentation = scene.segmentation;
  half->features = scene.features;
  return half;
}

}  // namespace

FeatureGrid::FeatureGrid(const SceneFeatures& features, int color_per_depth, cv::Size depth_size)
    : columns_((depth_size.width + kCell - 1) / kCell) {
  const int rows = (depth_size.height + kCell - 1) / kCell;
  const auto cellOf = [&](const cv::Point& pixel) {
    return static_cast<size_t>(pixel.y / kCell * columns_ + pixel.x / kCell);
  };
  first_.assign(static_cast<size_t>(columns_ * rows) + 1, 0);
  for (const Keypoint& keypoint : features.image.keypoints) {
    const Eigen::Vector2d place = depthPixel(keypoint, color_per_depth);
    pixels_.emplace_back(std::clamp(cvRound(place.x()), 0, depth_size.width - 1),
                         std::clamp(cvRound(place.y()), 0, depth_size.height - 1));
    ++first_[cellOf(pixels_.back()) + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  features_.resize(pixels_.size());
  for (size_t i = 0; i < pixels_.size(); ++i)
    features_[static_cast<size_t>(next[cellOf(pixels_[i])]++)] = static_cast<int>(i);
}

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
  scene.feature_grid = FeatureGrid(features, scene.color_per_depth, depth.size());
  scene.half = halved(scene);
  return scene;
}

}  // namespace recognition
