#include "rgbd_recognition/tracking/track.h"

namespace recognition {

const char* trackStateName(TrackState state) {
  switch (state) {
    case TrackState::kSeen:
      return "seen";
    case TrackState::kHidden:
      return "hidden";
    case TrackState::kNoDepth:
      return "no_depth";
    case TrackState::kDark:
      return "dark";
    case TrackState::kOutOfView:
      return "out_of_view";
    case TrackState::kDoubtful:
      return "doubtful";
  }
  return "";
}

const char* trackEndName(TrackEnd end) {
  switch (end) {
    case TrackEnd::kNone:
      return "";
    case TrackEnd::kTakenAway:
      return "taken_away";
    case TrackEnd::kLooksOther:
      return "looks_other";
    case TrackEnd::kNotSeen:
      return "not_seen";
    case TrackEnd::kOutOfView:
      return "out_of_view";
    case TrackEnd::kReplaced:
      return "replaced";
    case TrackEnd::kClockSetBack:
      return "clock_set_back";
    case TrackEnd::kModelGone:
      return "model_gone";
  }
  return "";
}

}  // namespace recognition
