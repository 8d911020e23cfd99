#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/core/pose.h"

namespace recognition {

std::string sixDigits(int number);  ///< "000042": how BOP names scenes, frames and models

/// An object that truly is in a frame.
struct GroundTruth {
  int object_id = 0;  ///< BOP obj_id = the challenge's dID
  Pose camera_from_object = Pose::Identity();
  double visibility = -1.0;  ///< share of its silhouette that is seen, 0..1; -1 where the data set does not say
};

/// One frame of a BOP split, not loaded yet.
struct BopFrame {
  int scene = 0;
  int frame = 0;
  std::string color_file;
  std::string depth_file;
  CameraModel camera;        ///< of the colour image; width and height are 0 until the image is loaded
  double depth_scale = 1.0;  ///< depth file's unit in millimetres
  std::vector<GroundTruth> ground_truth;

  std::string name() const;  ///< "000001/000000"
};

/// A split of a BOP data set (folder of scenes NNNNNN with rgb/, depth/, scene_camera.json, scene_gt.json and, where
/// there is one, scene_gt_info.json), frames in order of scene and frame. Throws std::runtime_error with file and
/// reason.
std::vector<BopFrame> readBopSplit(const std::string& split_directory);

/// An RgbdFrame that owns its pixels (colour BGR, depth CV_32FC1 metres). Throws std::runtime_error with file and
/// reason.
RgbdFrame loadBopFrame(const BopFrame& frame);

/// Colour, depth and a BOP scene_camera.json-like camera (cam_K, depth_scale; of the first frame) from single files.
RgbdFrame loadFrameFiles(const std::string& color_file, const std::string& depth_file, const std::string& camera_file);

}  // namespace recognition
