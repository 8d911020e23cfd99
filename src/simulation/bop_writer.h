#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/core/pose.h"
#include "simulation/visibility.h"

namespace recognition {

/// One object in a frame as BOP's scene_gt.json and scene_gt_info.json tell it.
struct AnnotatedObject {
  int object_id = 0;
  Pose camera_from_object = Pose::Identity();
  BodyVisibility visibility;  ///< in colour pixels
  int valid_depth = 0;        ///< silhouette pixels with a measured depth, colour pixels
};

struct AnnotatedFrame {
  RgbdFrame frame;  ///< colour BGR, depth CV_16UC1 mm
  std::vector<AnnotatedObject> objects;
};

/// Writes one split of a BOP data set, `frames_per_scene` frames a scene folder. Frames may come in any order and from
/// several threads; a frame is complete or absent, so that an interrupted run can go on. finish() makes the json files
/// of the scenes and the challenge's CSV.
class BopWriter {
 public:
  BopWriter(std::string directory, std::string split, int frames_per_scene);

  /// Says what the data set is made from. Throws std::runtime_error if an earlier run wrote something else there.
  void claim(const std::string& origin) const;

  bool has(int frame) const;  ///< whether an earlier run wrote it completely
  void write(int frame, const AnnotatedFrame& annotated) const;

  /// For frames 0 .. count - 1; throws std::runtime_error if one is missing.
  void finish(int count) const;

  /// Copies a BOP `models` folder to DIR/models.
  void copyModels(const std::string& models_directory) const;

 private:
  std::string sceneDirectory(int frame) const;
  std::string fragmentFile(int frame) const;

  std::string directory_;
  std::string split_;
  int frames_per_scene_;
};

}  // namespace recognition
