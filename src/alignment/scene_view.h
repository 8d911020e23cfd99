#pragma once

#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/segmentation/segmentation.h"

namespace recognition {

/// The scene's features by the place in the depth image at which they are seen.
class FeatureGrid {
 public:
  FeatureGrid() = default;
  FeatureGrid(const SceneFeatures& features, int color_per_depth, cv::Size depth_size);

  /// Calls visit(feature, pixel) for the features whose nearest pixel lies in `box`, row by row of cells.
  template <typename Visit>
  void forFeatures(const cv::Rect& box, Visit visit) const {
    if (box.empty() || first_.empty()) return;
    for (int row = box.y / kCell; row <= (box.y + box.height - 1) / kCell; ++row)
      for (int column = box.x / kCell; column <= (box.x + box.width - 1) / kCell; ++column) {
        const auto cell = static_cast<size_t>(row * columns_ + column);
        for (int i = first_[cell]; i < first_[cell + 1]; ++i) {
          const int feature = features_[static_cast<size_t>(i)];
          if (box.contains(pixels_[static_cast<size_t>(feature)]))
            visit(feature, pixels_[static_cast<size_t>(feature)]);
        }
      }
  }

 private:
  static constexpr int kCell = 16;  // pixels

  int columns_ = 0;
  std::vector<int> first_;         // of each cell in features_, and the end
  std::vector<int> features_;      // cell by cell
  std::vector<cv::Point> pixels_;  // of each feature
};

/// All that hypotheses of one frame are tested against; computed once a frame. Depth resolution throughout.
struct SceneView {
  cv::Mat depth;            ///< CV_32FC1 metres, 0 invalid
  cv::Mat lab;              ///< CV_32FC3 CIELAB
  cv::Mat clipped;          ///< CV_8UC1, 255 where a colour channel is saturated (>= 250)
  cv::Mat lightness;        ///< CV_32FC1, L of `lab` smoothed as a model's cloud is: what the refinement aligns to
  CameraModel camera;       ///< of `depth`
  int color_per_depth = 1;  ///< k of RgbdFrame: keypoints are in colour pixels
  const Segmentation* segmentation = nullptr;
  const SceneFeatures* features = nullptr;
  FeatureGrid feature_grid;               ///< of `features`
  std::shared_ptr<const SceneView> half;  ///< depth, lab, clipped and camera at half resolution; null in itself

  /// The two pointers are kept; depth is depthInMetres() of the frame.
  static SceneView make(const RgbdFrame& frame, const cv::Mat& depth, const Segmentation& segmentation,
                        const SceneFeatures& features);
};

/// Where a keypoint (colour pixels) lies in the depth image: colour pixels k u .. k u + k - 1 are depth pixel u.
inline Eigen::Vector2d depthPixel(const Keypoint& keypoint, int color_per_depth) {
  const double k = color_per_depth;
  return {(keypoint.x + 0.5) / k - 0.5, (keypoint.y + 0.5) / k - 0.5};
}

}  // namespace recognition
