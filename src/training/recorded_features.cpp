#include "training/recorded_features.h"

#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/point_grid.h"
#include "meshes/surface_orientation.h"
#include "features/lifting.h"
#include "rgbd_recognition/core/frame.h"
#include "training/feature_merging.h"

namespace recognition {
namespace {

constexpr int kMaskMargin =
    2;  // depth pixels; keypoints on the outline are found, and dropped if they lift to the background
constexpr float kMinFeatureCosine = 0.34f;  // of the slant, 70 degrees
constexpr float kSmoothing = 2.5f;          // cloud points within so many spacings make the local plane

// Looks features up on the cloud.
class SurfaceFinder {
 public:
  SurfaceFinder(const std::vector<SurfacePoint>& cloud, float reach) : cloud_(cloud), reach_(reach), grid_(reach) {
    for (size_t i = 0; i < cloud.size(); ++i) grid_.insert(cloud[i].position, static_cast<int>(i));
  }

  // Where the ray from `eye` through p meets the surface near p; false if there is none.
  bool project(const Eigen::Vector3f& eye, Eigen::Vector3f& p) const {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
    float sum = 0.0f;
    const Eigen::Vector3f ray = (p - eye).normalized();
    grid_.forNeighbours(p, [&](int i) {
      const SurfacePoint& point = cloud_[static_cast<size_t>(i)];
      const float distance = (point.position - p).norm() / reach_;
      if (distance >= 1.0f || -point.normal.dot(ray) < kMinFeatureCosine) return;
      const float weight = std::exp(-kSmoothing * kSmoothing * distance * distance);
      mean += weight * point.position;
      normal += weight * point.normal;
      sum += weight;
    });
    if (sum <= 0.0f) return false;
    normal.normalize();
    const float slope = normal.dot(ray);
    if (-slope < kMinFeatureCosine) return false;
    p += ray * (normal.dot(mean / sum - p) / slope);
    return true;
  }

 private:
  const std::vector<SurfacePoint>& cloud_;
  float reach_;
  PointGrid grid_;
};

// The features of an image as from `farther` times its distance, in pixels of the image as it is.
ImageFeatures extractFromFarther(const FeatureExtractor& extractor, const cv::Mat& gray, const cv::Mat& mask,
                                 double farther) {
  if (farther <= 1.0) return extractor.extract(gray, mask);
  cv::Mat small, small_mask;
  cv::resize(gray, small, cv::Size(), 1.0 / farther, 1.0 / farther, cv::INTER_AREA);
  cv::resize(mask, small_mask, small.size(), 0, 0, cv::INTER_NEAREST);
  ImageFeatures features = extractor.extract(small, small_mask);
  const float across = static_cast<float>(gray.cols) / static_cast<float>(small.cols);
  const float down = static_cast<float>(gray.rows) / static_cast<float>(small.rows);
  for (Keypoint& keypoint : features.keypoints) {
    keypoint.x = (keypoint.x + 0.5f) * across - 0.5f;
    keypoint.y = (keypoint.y + 0.5f) * down - 0.5f;
    keypoint.size *= across;
  }
  return features;
}

ModelFeatures featuresOfView(const ObjectView& view, double farther, const SurfaceFinder& surface,
                             const FeatureExtractor& extractor, const FeatureParameters& features) {
  cv::Mat grown;
  cv::dilate(view.mask, grown, cv::Mat(), cv::Point(-1, -1), kMaskMargin);
  const cv::Mat mask = toColorSize(grown, view.color.size(), view.color_per_depth);
  const SceneFeatures scene =
      liftFeatures(extractFromFarther(extractor, toGray(view.color, ColorOrder::kRgb), mask, farther), view.depth,
                   view.depth_camera, view.color_per_depth, features.lifting);
  const Pose world_from_camera = view.camera_from_world.inverse();
  const Eigen::Vector3f eye = view.cameraPlace();
  ModelFeatures placed;
  for (int i = 0; i < scene.image.count(); ++i) {
    const auto k = static_cast<size_t>(i);
    Eigen::Vector3f p = (world_from_camera * scene.points[k].cast<double>()).cast<float>();
    if (!surface.project(eye, p)) continue;
    placed.descriptors.push_back(scene.image.descriptors.row(i));
    placed.positions.push_back(p);
    placed.view_directions.push_back((eye - p).normalized());
    placed.orientations.push_back(
        surfaceOrientation(scene.image.keypoints[k].angle, placed.view_directions.back(), world_from_camera));
    placed.sizes.push_back(scene.image.keypoints[k].size * scene.points[k].z() /
                           static_cast<float>(view.color_camera.fx));
    placed.views.push_back(1);
  }
  return placed;
}

}  // namespace

ModelFeatures recordedFeatures(const std::vector<ObjectView>& views, const std::vector<SurfacePoint>& cloud,
                               FeatureParameters features, DescriptorType type, const RecordingParameters& parameters) {
  features.descriptor = type;
  features.max_features = 0;  // a limit for scenes
  const auto extractor = makeFeatureExtractor(features);
  const SurfaceFinder surface(cloud, static_cast<float>(parameters.feature_distance));
  std::vector<std::pair<const ObjectView*, double>> looks;  // a view, and how many times farther away
  for (int i = 0; i < parameters.distances; ++i)
    for (const ObjectView& view : views) {
      const double farthest = parameters.far_distance / static_cast<double>(view.cameraPlace().norm());
      const double share = i == 0 ? 0.0 : static_cast<double>(i) / (parameters.distances - 1);
      if (i == 0 || farthest > 1.0) looks.emplace_back(&view, std::pow(farthest, share));
    }
  std::vector<ModelFeatures> by_look(looks.size());
  cv::parallel_for_(cv::Range(0, static_cast<int>(looks.size())), [&](const cv::Range& range) {
    for (auto i = static_cast<size_t>(range.start); i < static_cast<size_t>(range.end); ++i)
      by_look[i] = featuresOfView(*looks[i].first, looks[i].second, surface, *extractor, features);
  });
  return mergeFeatures(by_look, parameters.merging);
}

}  // namespace recognition
