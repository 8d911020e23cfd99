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
  bool has_ground_truth = false;  ///< whether scene_gt.json tells of it, be it of no object

  std::string name() const;  ///< "000001/000000"
};

struct BopSplitOptions {
  std::string sensor;         ///< of data sets with several: as in rgb_SENSOR; empty: the only one
  bool only_targets = false;  ///< only the frames of the data set's test_targets_bop*.json, where it has one
};

/// A split of a BOP data set.
struct BopSplit {
  std::vector<BopFrame> frames;      ///< those of which both images are there, in order of scene and frame
  std::vector<std::string> missing;  ///< those that scene_camera.json lists beside: which, and what is missing
  std::string targets_file;          ///< that chose the frames; "" if none did
};

/// The folder of scenes NNNNNN with rgb/ or gray/, depth/, scene_camera.json and, where there are such, scene_gt.json
/// and scene_gt_info.json; images as PNG, JPEG, TIFF. Throws std::runtime_error with file and reason, also if no frame
/// is there.
BopSplit openBopSplit(const std::string& split_directory, const BopSplitOptions& options = {});

/// Its frames alone.
std::vector<BopFrame> readBopSplit(const std::string& split_directory);

/// What is missing, for people: the number, and the first ones; "" if nothing is.
std::string describeMissing(const BopSplit& split);

/// An RgbdFrame that owns its pixels (colour BGR as it is stored, without EXIF's rotation; depth CV_32FC1 metres).
/// Throws std::runtime_error with file and reason.
RgbdFrame loadBopFrame(const BopFrame& frame);

/// Colour, depth and camera from single files. doc/files.md lists the kinds of camera files; of a scene_camera.json, the
/// entry of the number in the colour file's name is taken. Distortion is undone.
RgbdFrame loadFrameFiles(const std::string& color_file, const std::string& depth_file, const std::string& camera_file);

}  // namespace recognition
