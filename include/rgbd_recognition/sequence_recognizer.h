#pragma once

#include <memory>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/recognizer.h"
#include "rgbd_recognition/tracking/track.h"
#include "rgbd_recognition/tracking/tracking_parameters.h"

namespace recognition {

/// Recognises objects in a film: tracks answer each frame, and what they do not explain is searched from time to time,
/// as the nodelets do it. A search takes some of the film's time, as if it went on beside; its result is brought to the
/// frame at which it ends. Not for concurrent use.
class SequenceRecognizer {
 public:
  /// `search_seconds`: of the film's time that a search takes; 0: as long as it took here, so that two runs may differ.
  /// Throws std::invalid_argument as the parameters' validate() does.
  SequenceRecognizer(const RecognizerParameters& parameters, const TrackingParameters& tracking,
                     std::shared_ptr<const ModelDatabase> database, double search_seconds = 0.0);
  ~SequenceRecognizer();

  /// The next frame; `stamp` in seconds. `fixed_from_camera`: where the camera was, the identity if nobody knows. A frame
  /// must fit: std::invalid_argument.
  TrackingOutcome next(double stamp, const RgbdFrame& frame, const Pose& fixed_from_camera = Pose::Identity());

  double trackingSeconds() const;  ///< wall time that following took in the last frame
  double searchSeconds() const;    ///< wall time of the search that began with the last frame; 0: none did
  int searches() const;            ///< so far

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace recognition
