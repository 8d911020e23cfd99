#include "verification/texture_match.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/angles.h"
#include "core/simd.h"
#include "verification/pixel_consistency.h"

namespace recognition {
namespace {

constexpr float kAlike = 0.35f;                               // distance of unit-length descriptors
constexpr float kMinFacing = 0.26f;                           // cosine of 75 degrees, between trained view and camera
constexpr float kMaxRatio = 2.0f;                             // of metric sizes
constexpr float kMinOrientation = 0.766f;                     // cosine of 40 degrees, between orientations in the image
constexpr float kMaxDepthOff = 0.025f;                        // metres, of a model feature from the scene feature
constexpr int kMaxFeatures = 160;                             // scene features compared; of more, evenly spread ones
constexpr std::array<float, 2> kSlides = {0.030f, 0.045f};    // metres
constexpr std::array<float, 2> kRotations = {-60.0f, 60.0f};  // degrees, beyond what orientations may differ by
constexpr float kUnseen = 0.5f;  // matches that a control pose is given beside those observed

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

/// A scene feature on the model, in the depth image.
struct Seen {
  int feature;
  Eigen::Vector2f pixel, direction;  // direction: of its orientation, unit
  float z, size;                     // metres
};

/// A model feature that faces the camera, in the depth image.
struct Expected {
  int feature;
  Eigen::Vector2f pixel, direction;
  float z, size;
};

/// Moves pixels and orientations as a control pose does.
struct ImageMotion {
  Eigen::Matrix2f rotation = Eigen::Matrix2f::Identity();
  Eigen::Vector2f slide = Eigen::Vector2f::Zero();
  bool control = true;
};

/// Rotations say nothing where the model's features have no orientations.
std::vector<ImageMotion> controlMotions(float pixels_per_metre, bool rotations) {
  std::vector<ImageMotion> motions;
  for (size_t ring = 0; ring < kSlides.size(); ++ring)
    for (int i = 0; i < 4; ++i) {
      ImageMotion motion;
      const double angle = kPi * (0.5 * i + 0.25 * static_cast<double>(ring));
      motion.slide = kSlides[ring] * pixels_per_metre *
                     Eigen::Vector2f(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
      motions.push_back(motion);
    }
  if (!rotations) return motions;
  for (const float degrees : kRotations) {
    ImageMotion motion;
    motion.rotation = Eigen::Rotation2Df(degrees * static_cast<float>(kPi) / 180.0f).toRotationMatrix();
    motions.push_back(motion);
  }
  return motions;
}

class TextureComparison {
 public:
  TextureComparison(const ModelFeatures& model, const Pose& pose, const SceneView& scene, const cv::Rect& box)
      : model_(model), scene_(scene), descriptors_(quantizedDescriptors(model.descriptors)), box_(box) {
    project(pose);
  }

  int count(const std::vector<Seen>& seen, const Eigen::Vector2f& middle, const ImageMotion& motion) const {
    int matched = 0;
    for (const Seen& one : seen) {
      const Eigen::Vector2f pixel = middle + motion.rotation * (one.pixel - middle) + motion.slide;
      matched += isThere(one, pixel, motion.rotation * one.direction, motion.control) ? 1 : 0;
    }
    return matched;
  }

 private:
  /// The model's features that face the camera, in cells of the image.
  void project(const Pose& pose) {
    const Eigen::Isometry3f camera_from_object = pose.cast<float>();
    const Eigen::Vector3f eye = camera_from_object.inverse().translation();
    const auto fx = static_cast<float>(scene_.camera.fx), fy = static_cast<float>(scene_.camera.fy);
    const auto cx = static_cast<float>(scene_.camera.cx), cy = static_cast<float>(scene_.camera.cy);
    reach_ = kTextureReach * fx / std::max(0.1f, camera_from_object.translation().z());
    columns_ = static_cast<int>(static_cast<float>(box_.width) / reach_) + 3;
    rows_ = static_cast<int>(static_cast<float>(box_.height) / reach_) + 3;
    cells_.assign(static_cast<size_t>(columns_ * rows_), {});
    for (int i = 0; i < model_.count(); ++i) {
      const auto m = static_cast<size_t>(i);
      const Eigen::Vector3f towards = (eye - model_.positions[m]).normalized();
      if (model_.view_directions[m].dot(towards) < kMinFacing) continue;
      const Eigen::Vector3f p = camera_from_object * model_.positions[m];
      if (p.z() < 0.05f) continue;
      Expected expected{i, {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy}, {0.0f, 0.0f}, p.z(), model_.sizes[m]};
      if (!model_.orientations.empty()) {
        const Eigen::Vector3f o = camera_from_object.linear() * model_.orientations[m];
        expected.direction = Eigen::Vector2f(o.x() - o.z() * p.x() / p.z(), o.y() - o.z() * p.y() / p.z());
        expected.direction.normalize();
      }
      if (const int cell = cellOf(expected.pixel); cell >= 0) cells_[static_cast<size_t>(cell)].push_back(expected);
    }
  }

  int cellOf(const Eigen::Vector2f& pixel) const {
    const int column = static_cast<int>(std::floor((pixel.x() - static_cast<float>(box_.x)) / reach_)) + 1;
    const int row = static_cast<int>(std::floor((pixel.y() - static_cast<float>(box_.y)) / reach_)) + 1;
    return column < 0 || row < 0 || column >= columns_ || row >= rows_ ? -1 : row * columns_ + column;
  }

  bool isThere(const Seen& seen, const Eigen::Vector2f& pixel, const Eigen::Vector2f& direction, bool control) const {
    const int cell = cellOf(pixel);
    if (cell < 0) return false;
    const int row = cell / columns_, column = cell % columns_;
    for (int v = std::max(0, row - 1); v <= std::min(rows_ - 1, row + 1); ++v)
      for (int u = std::max(0, column - 1); u <= std::min(columns_ - 1, column + 1); ++u)
        for (const Expected& one : cells_[static_cast<size_t>(v * columns_ + u)])
          if (agree(seen, pixel, direction, one, control)) return true;
    return false;
  }

  bool agree(const Seen& seen, const Eigen::Vector2f& pixel, const Eigen::Vector2f& direction, const Expected& one,
             bool control) const {
    if ((one.pixel - pixel).squaredNorm() > reach_ * reach_) return false;
    if (!control && std::abs(one.z - seen.z) > kMaxDepthOff) return false;
    if (seen.size > kMaxRatio * one.size || one.size > kMaxRatio * seen.size) return false;
    if (!model_.orientations.empty() && one.direction.dot(direction) < kMinOrientation) return false;
    return squaredDistance(descriptors_.ptr<std::int8_t>(one.feature),
                           scene_.features->image.descriptors.ptr<float>(seen.feature),
                           descriptors_.cols) < kAlike * kAlike;
  }

  const ModelFeatures& model_;
  const SceneView& scene_;
  cv::Mat descriptors_;
  cv::Rect box_;
  float reach_ = 1.0f;  // pixels: kTextureReach at the object's distance
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<Expected>> cells_;
};

std::vector<Seen> featuresOn(const ReprojectedModel& reprojected, const cv::Mat& state, const SceneView& scene) {
  std::vector<Seen> seen;
  const float focal = static_cast<float>(scene.camera.fx) * static_cast<float>(scene.color_per_depth);
  scene.feature_grid.forFeatures(reprojected.box, [&](int feature, const cv::Point& pixel) {
    if (state.at<PixelState>(pixel - reprojected.box.tl()) != PixelState::kConsistent) return;
    const Keypoint& keypoint = scene.features->image.keypoints[static_cast<size_t>(feature)];
    const float z = scene.features->points[static_cast<size_t>(feature)].z();
    seen.push_back({feature,
                    depthPixel(keypoint, scene.color_per_depth).cast<float>(),
                    {std::cos(keypoint.angle), std::sin(keypoint.angle)},
                    z,
                    keypoint.size * z / focal});
  });
  return seen;
}

/// Of too many every n-th.
std::vector<Seen> spread(const std::vector<Seen>& all) {
  if (all.size() <= kMaxFeatures) return all;
  std::vector<Seen> some;
  for (size_t i = 0; i < kMaxFeatures; ++i) some.push_back(all[i * all.size() / kMaxFeatures]);
  return some;
}

Eigen::Vector2f middleOf(const std::vector<Seen>& seen) {
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  for (const Seen& one : seen) sum += one.pixel;
  return sum / std::max(1.0f, static_cast<float>(seen.size()));
}

}  // namespace

double significanceOf(int features, int matched, int best_control) {
  if (features == 0 || matched == 0) return 0.0;
  const double n = features, k = std::min(matched, features);
  const double chance = std::min(1.0, (best_control + static_cast<double>(kUnseen)) / (n + kUnseen)), rate = k / n;
  if (rate <= chance) return 0.0;
  const double missed = n > k ? (n - k) * std::log((1.0 - rate) / (1.0 - chance)) : 0.0;
  return k * std::log(rate / chance) + missed;
}

TextureMatch matchTexture(const ModelFeatures& model, const Pose& camera_from_object,
                          const ReprojectedModel& reprojected, const cv::Mat& state, const SceneView& scene) {
  TextureMatch result;
  const ImageFeatures& image = scene.features->image;
  if (image.descriptors.rows != image.count() || image.descriptors.cols != model.descriptors.cols)
    return result;  // features whose descriptors did not come along
  const std::vector<Seen> all = featuresOn(reprojected, state, scene);
  result.features = static_cast<int>(all.size());
  if (all.empty()) return result;
  const std::vector<Seen> seen = spread(all);
  const Eigen::Vector2f middle = middleOf(seen);
  const TextureComparison comparison(model, camera_from_object, scene, reprojected.box);
  ImageMotion none;
  none.control = false;
  const int here = comparison.count(seen, middle, none);
  const auto scaled = [&](int count) { return static_cast<int>(count * all.size() / seen.size()); };
  result.matched = scaled(here);
  if (here == 0) return result;
  const auto z = static_cast<float>(std::max(0.1, camera_from_object.translation().z()));
  int best = 0;
  for (const ImageMotion& motion : controlMotions(static_cast<float>(scene.camera.fx) / z, !model.orientations.empty()))
    best = std::max(best, comparison.count(seen, middle, motion));
  result.best_control = scaled(best);
  result.significance = significanceOf(static_cast<int>(seen.size()), here, best);
  return result;
}

}  // namespace recognition
