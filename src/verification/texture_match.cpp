#include "verification/texture_match.h"

#include <cmath>

#include "core/simd.h"
#include "verification/pixel_consistency.h"

namespace recognition {
namespace {

constexpr float kAlike = 0.35f;         // distance of unit-length descriptors
constexpr float kMinFacing = 0.26f;  // cosine of 75 degrees, between trained view and camera
constexpr float kMaxRatio = 2.0f;  // of metric sizes

/// Of descriptors whose length is a multiple of kLanes.
RGBD_SIMD_CLONES float squaredDistance(const std::int8_t* quantized, const float* unit, int n) {
  constexpr int kLanes = 16;  // partial sums, added in a fixed order
  float sums[kLanes] = {}, sum = 0.0f;
  for (int i = 0; i < n; i += kLanes)
    for (int lane = 0; lane < kLanes; ++lane) {
      const float difference = static_cast<float>(quantized[i + lane]) * (1.0f / kDescriptorScale) - unit[i + lane];
      sums[lane] += difference * difference;
    }
  for (const float part : sums) sum += part;
  return sum;
}

}  // namespace

TextureMatch matchTexture(const ModelFeatures& model, const PointGrid& grid, const Pose& camera_from_object,
                      const ReprojectedModel& reprojected, const cv::Mat& state, const SceneView& scene) {
  TextureMatch result;
  const SceneFeatures& features = *scene.features;
  if (features.image.descriptors.rows != features.image.count() ||
      features.image.descriptors.cols != model.descriptors.cols)
    return result;  // features whose descriptors did not come along
  const cv::Mat model_descriptors = quantizedDescriptors(model.descriptors);
  const Eigen::Isometry3f object_from_camera = camera_from_object.inverse().cast<float>();
  const Eigen::Vector3f eye = object_from_camera.translation();  // the camera's place on the object
  const float focal = static_cast<float>(scene.camera.fx) * static_cast<float>(scene.color_per_depth);
  for (int i = 0; i < features.image.count(); ++i) {
    const Keypoint& keypoint = features.image.keypoints[static_cast<size_t>(i)];
    const Eigen::Vector2d in_depth = depthPixel(keypoint, scene.color_per_depth);
    const cv::Point pixel(cvRound(in_depth.x()), cvRound(in_depth.y()));
    const cv::Point in_box = pixel - reprojected.box.tl();
    if (!reprojected.box.contains(pixel) || state.at<PixelState>(in_box) != PixelState::kConsistent) continue;
    ++result.features;
    const Eigen::Vector3f& seen = features.points[static_cast<size_t>(i)];
    const Eigen::Vector3f place = object_from_camera * seen;
    const Eigen::Vector3f towards_camera = (eye - place).normalized();
    const float size = keypoint.size * seen.z() / focal;
    bool alike = false;
    grid.forNeighbours(place, [&](int j) {
      const auto m = static_cast<size_t>(j);
      if (alike || (model.positions[m] - place).squaredNorm() > kTextureReach * kTextureReach) return;
      if (model.view_directions[m].dot(towards_camera) < kMinFacing) return;
      if (size > kMaxRatio * model.sizes[m] || model.sizes[m] > kMaxRatio * size) return;
      alike = squaredDistance(model_descriptors.ptr<std::int8_t>(j), features.image.descriptors.ptr<float>(i),
                              model_descriptors.cols) < kAlike * kAlike;
    });
    if (alike) ++result.matched;
  }
  return result;
}

}  // namespace recognition
