#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"

namespace recognition {

/// Kinds of edge points (Sec. IV, Fig. 3b); the values of `Segmentation::edges`.
enum class EdgeType : std::uint8_t { kNone = 0, kJump = 1, kConvexCrease = 2, kConcaveCrease = 3 };

/// A smooth surface patch: one region of interest S of the paper, with the PCA of its 3D points.
struct Patch {
  int label = 0;  ///< its value in `Segmentation::labels`, >= 1
  int pixels = 0;
  cv::Rect box;                 ///< in the depth image
  Eigen::Vector3f centroid;     ///< camera optical frame, metres
  Eigen::Vector3f eigenvalues;  ///< of the covariance, ascending, square metres
  Eigen::Matrix3f axes;         ///< eigenvectors as columns, same order
};

/// Labels of pixels that belong to no patch.
constexpr int kUnlabelled = 0;   ///< invalid depth, edge, or a component of the wrong size
constexpr int kLargePlane = -1;  ///< removed: a plane too large for any trained object

struct Segmentation {
  cv::Mat labels;              ///< CV_32SC1, depth resolution: >= 1 patch, kUnlabelled, kLargePlane
  cv::Mat edges;               ///< CV_8UC1, depth resolution: EdgeType
  std::vector<Patch> patches;  ///< patches[i].label == i + 1
};

/// Throws std::invalid_argument that names both sizes if labels or edges have another one than the depth image.
void requireSameSize(const Segmentation& segmentation, const cv::Mat& depth);

/// Pixel counts, boxes and PCA of the components of at least `min_pixels` pixels among those with the labels
/// 1 .. `count` - 1 (CV_32SC1; none may be greater), by label.
std::vector<Patch> describePatches(const cv::Mat& depth, const CameraModel& camera, const cv::Mat& labels, int count,
                                   int min_pixels = 1);

/// A mask (CV_8UC1) of depth's size at colour resolution; what depth does not cover is 0, what colour does not
/// cover is left out.
cv::Mat toColorSize(const cv::Mat& mask, cv::Size color_size, int color_per_depth);

/// The global mask of Sec. V at colour resolution (CV_8UC1, 255 inside a region of interest), grown by `margin` depth
/// pixels so that features on outlines survive. `color_size` may exceed the depth's k-fold rows.
cv::Mat regionMask(const Segmentation& segmentation, cv::Size color_size, int color_per_depth, int margin);

}  // namespace recognition
