#pragma once

#include "rgbd_recognition/core/parameters.h"

namespace recognition {

/// Parameters of ObjectTracker and of what is left to be searched beside its tracks.
struct TrackingParameters {
  double sure_confidence = 0.8;  ///< a detection from here on begins a track that counts as found at once
  int confirm_detections = 2;    ///< a less sure one must be repeated so often
  double lost_after = 0.5;       ///< seconds in which a track may contradict the frames
  double hidden_for = 30.0;      ///< seconds that something may stand before it
  double unseen_for = 10.0;      ///< seconds without depth or in the dark
  double forget_after = 60.0;    ///< seconds out of view
  double max_distance = 0.06;    ///< metres between a track and a detection of it
  double max_angle = 30.0;       ///< degrees between them; beyond, the two are compared in the frame
  double search_period = 5.0;    ///< seconds after which the whole frame is searched again
  double clock_step = 1.0;       ///< seconds: an older stamp by more is a clock that was set back, by less a late frame

  ParameterList list();
  void validate() const;
};

}  // namespace recognition
