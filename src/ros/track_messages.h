#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/model/object_model.h"
#include "ros/messages.h"
#include "rgbd_recognition/tracking/track.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"

namespace recognition {

/// The accepted ones, as far as a message tells of them. Throws std::invalid_argument that names object and value of
/// what does not fit: unknown object or source, a pose that is none, a number out of range.
std::vector<VerifiedHypothesis> detectionsFromMessage(const messages::DetectionArray& message,
                                                      const ModelDatabase& database);

/// `with_frames`: tracks have tf frames, with that prefix.
messages::Track toMessage(const Track& track, bool with_frames, const std::string& prefix);

/// What is found in a frame by its tracks, the camera's frame: all but those that are doubtful or out of view. Those
/// that are `found` with this frame keep their detector's source, the others have "track".
messages::DetectionArrayPtr detectionsOf(const TrackingOutcome& outcome, const Pose& camera_from_fixed,
                                         const std_msgs::Header& header);

}  // namespace recognition
