#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"

namespace recognition {

/// A depth image, with labels where the data set has them.
struct DepthFrame {
  std::string name;
  cv::Mat depth;   ///< CV_32FC1 metres, 0 invalid
  cv::Mat labels;  ///< CV_32SC1: 0 none, 1-9 table, 10 k .. 10 k + 9 parts of object k - 1; empty without labels
  CameraModel camera;
};

/// All .pcd of a folder with fields label, x, y, z (Kinect v1, f = 525 pixels), by name. Throws std::runtime_error for
/// a folder without any.
std::vector<DepthFrame> readLabelledClouds(const std::string& directory);

/// Depth of all frames of a split of a BOP data set. Throws std::runtime_error for a folder without any.
std::vector<DepthFrame> readBopDepth(const std::string& split_directory);

/// Sums over frames of what segmentation did to labelled pixels.
struct SegmentationQuality {
  double object_pixels = 0;  ///< with label of an object and valid depth
  double covered = 0;        ///< of these in a patch
  double mixed = 0;  ///< of these in a patch whose majority has another label (of another object, the table, or none)
  double table_pixels = 0;
  double table_left = 0;  ///< in a patch
  double objects = 0;
  double missed = 0;   ///< objects without a patch of which they are the majority
  double patches = 0;  ///< whose majority is an object

  /// `patches`: CV_32SC1, >= 1 inside a patch.
  void add(const DepthFrame& frame, const cv::Mat& patches);
  double underSegmentation() const { return mixed / object_pixels; }
  double coverage() const { return covered / object_pixels; }
  double tableLeft() const { return table_left / table_pixels; }
  double missedShare() const { return missed / objects; }
  double patchesPerObject() const { return patches / objects; }
};

}  // namespace recognition
