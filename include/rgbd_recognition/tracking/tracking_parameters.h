#pragma once

#include "rgbd_recognition/core/parameters.h"

namespace recognition {

/// Parameters of Tracker.
struct TrackingParameters {
  int confirm_frames = 2;            ///< detections before a track counts as found
  double lost_after = 1.0;           ///< seconds in view without a detection
  double forget_after = 60.0;        ///< seconds out of view
  double max_distance = 0.06;        ///< metres between a track and a detection of it
  double max_angle = 45.0;           ///< degrees between them; beyond, the detection contradicts the pose
  double drift_translation = 0.002;  ///< metres per square root of a second: how still an object stands
  double drift_rotation = 0.5;       ///< degrees per square root of a second
  double least_translation = 0.002;  ///< metres, standard deviation that a detection has at least
  double least_rotation = 0.7;       ///< degrees, likewise
  double view_width = 57.0;          ///< degrees, of the camera
  double view_height = 43.0;         ///< degrees

  ParameterList list();
  void validate() const;
};

}  // namespace recognition
