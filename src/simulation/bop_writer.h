#pragma once

#include <optional>
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
  std::optional<Pose> camera_from_world;  ///< cam_R_w2c and cam_t_w2c, where the camera moves in one world
};

/// Writes one split of a BOP data set, `frames_per_scene` frames a scene folder. Frames may come in any order, from
/// several threads and processes. A frame is complete or absent, and the scene's json files hold all that are complete:
/// an interrupted run can go on, and what is there can be read at any time. finish() makes the challenge's CSV.
class BopWriter {
 public:
  BopWriter(std::string directory, std::string split, int frames_per_scene);

  /// Says what the data set is made from. Throws std::runtime_error if an earlier run wrote something else there.
  void claim(const std::string& origin) const;

  bool has(int frame) const;  ///< whether an earlier run wrote it completely
  void write(int frame, const AnnotatedFrame& annotated) const;

  /// Whether an earlier run left frames.
  bool started() const;

  /// For frames 0 .. count - 1; throws std::runtime_error if one is missing and `partly` does not allow it.
  void finish(int count, bool partly = false) const;

  /// Copies a BOP `models` folder to DIR/models.
  void copyModels(const std::string& models_directory) const;

 private:
  int scenesOf(int frames) const { return (frames + frames_per_scene_ - 1) / frames_per_scene_; }
  void publish(int scene) const;  // the json files of the frames that are there
  std::string sceneDirectory(int frame) const;
  std::string claimFile() const;
  std::string fragmentFile(int frame) const;

  std::string directory_;
  std::string split_;
  int frames_per_scene_;
};

}  // namespace recognition
