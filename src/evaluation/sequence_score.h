#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"

namespace recognition {

/// What was said of one object in one frame of a film.
struct SequenceAnswer {
  int object_id = -1;
  int instance = 0;  ///< lasting number among those of this object
  Pose camera_from_object = Pose::Identity();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the object, in its own frame: where it is said to be
};

struct SequenceFrame {
  double stamp = 0.0;              ///< seconds
  std::vector<GroundTruth> truth;  ///< in the same order in each frame of a film
  std::vector<SequenceAnswer> answers;
  double seconds = 0.0;  ///< wall time that the answer took
};

/// How well the objects of films are followed.
struct SequenceScore {
  int frames = 0;
  int visible = 0;           ///< true instances that are visible enough, over all frames
  int tight = 0, loose = 0;  ///< of these with a pose within 1 cm and 2 degrees, within 3 cm and 20 degrees
  double jitter_translation = 0.0, jitter_rotation = 0.0;  ///< of standing objects: standard deviation, m and degrees
  int standing = 0;                                        ///< poses that the jitter is of
  std::vector<double> first_pose;  ///< seconds from first visibility to the first loose pose, of those that got one
  int never_found = 0;             ///< instances that got none
  int switches = 0;                ///< of an instance's number
  int false_frames = 0, false_tracks = 0;  ///< answers that no instance explains, and the different numbers among them
  std::vector<double> seconds;             ///< wall time of each frame's answer

  void add(const SequenceScore& film);
};

/// Of one film. Visible enough: from a visibility of `min_visibility` on, or where the data set does not tell.
SequenceScore scoreSequence(const std::vector<SequenceFrame>& film, double min_visibility = 0.3);

/// For people, and as JSON.
std::string sequenceText(const std::string& name, const SequenceScore& score);
std::string sequenceJson(const SequenceScore& score);

}  // namespace recognition
