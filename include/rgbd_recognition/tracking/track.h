#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/matching/hypothesis.h"

namespace recognition {

/// What the last frame showed of a track.
enum class TrackState {
  kSeen,       ///< the frame agrees with it
  kHidden,     ///< something stands before it
  kNoDepth,    ///< the depth image has a hole there
  kDark,       ///< too dark to tell by its looks; depth agrees
  kOutOfView,  ///< it left the image
  kDoubtful    ///< the frame contradicts; given up if that lasts
};
const char* trackStateName(TrackState state);  ///< "seen", "hidden", "no_depth", "dark", "out_of_view", "doubtful"

/// Why a track was given up.
enum class TrackEnd {
  kNone,
  kTakenAway,     ///< the scene is seen through it
  kLooksOther,    ///< something of its shape looks otherwise: a twin, or its texture has slid
  kNotSeen,       ///< hidden, without depth or in the dark for too long
  kOutOfView,     ///< out of view for too long
  kReplaced,      ///< another object explains its pixels better
  kClockSetBack,  ///< time went backwards
  kModelGone      ///< the store has no such model any more
};
const char* trackEndName(TrackEnd end);  ///< "", "taken_away", "looks_other", "not_seen", "out_of_view", ...

/// An object followed over frames. The fixed frame is the camera's where nobody tells how the camera moves.
struct Track {
  std::string object;
  int object_index = -1;  ///< in the models
  int instance = 0;       ///< among the tracks of this object, from 0; stays for as long as the track lives
  Pose fixed_from_object = Pose::Identity();
  /// Of the object's origin (x y z, metres) and of the rotation about it (x y z, radians), in the fixed frame's axes.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();
  /// Of the model's centre (x y z, metres a second), and rotation (x y z, radians a second), in the fixed frame's axes;
  /// zero while it stands.
  Eigen::Matrix<double, 6, 1> velocity = Eigen::Matrix<double, 6, 1>::Zero();
  double confidence = 0.0;  ///< 0..1; falls while the frames contradict
  double visible = 0.0;     ///< share of its near side that is in view and not hidden, 0..1
  int detections = 0;       ///< that agreed with it
  double first_seen = 0.0;  ///< stamp of the frame it was first detected in, seconds
  double last_seen = 0.0;   ///< stamp of the last frame that agreed
  bool confirmed = false;
  TrackState state = TrackState::kSeen;
  TrackEnd end = TrackEnd::kNone;                          ///< of a lost one
  HypothesisSource source = HypothesisSource::kConsensus;  ///< of its detection
};

/// What a frame changed.
struct TrackingOutcome {
  std::vector<Track> tracks;  ///< the confirmed ones, by object and instance
  std::vector<Track> found;   ///< confirmed by this frame
  std::vector<Track> lost;    ///< given up with this frame, of those that were confirmed
  bool ignored = false;       ///< the frame came twice or late: nothing was looked at
  bool restarted = false;     ///< time went backwards: all earlier tracks were given up
};

}  // namespace recognition
