#include "ros/track_messages.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <boost/make_shared.hpp>

#include "ros/message_conversions.h"
#include "ros/detection_output.h"

namespace recognition {
namespace {

using RowMajor6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

HypothesisSource sourceFromName(const std::string& name) {
  for (int i = 0; i < kHypothesisSources; ++i)
    if (name == sourceName(static_cast<HypothesisSource>(i))) return static_cast<HypothesisSource>(i);
  throw std::invalid_argument("a detection has source '" + name + "'");
}

void requireInRange(double value, double max, const std::string& object, const char* name) {
  if (!(value >= 0.0 && value <= max))
    throw std::invalid_argument(object + " has " + name + " " + std::to_string(value));
}

VerifiedHypothesis fromMessage(const messages::Detection& message, const ModelDatabase& database) {
  VerifiedHypothesis detection;
  detection.hypothesis.object = database.find(message.object);
  if (detection.hypothesis.object < 0) throw std::invalid_argument("no model is named '" + message.object + "'");
  detection.hypothesis.source = sourceFromName(message.source);
  detection.camera_from_object = detection.hypothesis.camera_from_object = poseFromMessage(message.pose.pose);
  detection.covariance = Eigen::Map<const RowMajor6d>(message.pose.covariance.data());
  if (!detection.covariance.allFinite())
    throw std::invalid_argument(message.object + " has a covariance that is not finite");
  requireInRange(message.confidence, 1.0, message.object, "confidence");
  requireInRange(message.significance, 1e9, message.object, "significance");
  requireInRange(message.segment_share, 1.0, message.object, "segment_share");
  detection.confidence = message.confidence;
  detection.scores.visible = message.visible;
  detection.evidence.inliers = static_cast<int>(std::min<std::uint32_t>(message.inliers, 1000000));
  detection.evidence.significance = message.significance;
  detection.evidence.segment_share = message.segment_share;
  return detection;
}

void setPose(const Track& track, const Pose& target_from_fixed, geometry_msgs::PoseWithCovariance* message) {
  message->pose = poseMessage(target_from_fixed * track.fixed_from_object);
  RowMajor6d turn = RowMajor6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = target_from_fixed.linear();
  Eigen::Map<RowMajor6d>(message->covariance.data()) = turn * track.covariance * turn.transpose();
}

}  // namespace

std::vector<VerifiedHypothesis> detectionsFromMessage(const messages::DetectionArray& message,
                                                      const ModelDatabase& database) {
  std::vector<VerifiedHypothesis> detections;
  for (const messages::Detection& detection : message.detections)
    if (detection.accepted) detections.push_back(fromMessage(detection, database));
  return detections;
}

messages::Track toMessage(const Track& track, bool with_frames, const std::string& prefix) {
  messages::Track message;
  message.object = track.object;
  message.instance = static_cast<std::uint32_t>(track.instance);
  if (with_frames) {
    messages::Detection named;
    named.object = message.object;
    named.instance = message.instance;
    message.frame = frameName(named, prefix);
  }
  setPose(track, Pose::Identity(), &message.pose);
  message.velocity.linear.x = track.velocity[0];
  message.velocity.linear.y = track.velocity[1];
  message.velocity.linear.z = track.velocity[2];
  message.velocity.angular.x = track.velocity[3];
  message.velocity.angular.y = track.velocity[4];
  message.velocity.angular.z = track.velocity[5];
  message.confidence = track.confidence;
  message.visible = track.visible;
  message.state = trackStateName(track.state);
  message.reason = trackEndName(track.end);
  message.detections = static_cast<std::uint32_t>(track.detections);
  message.first_seen.fromSec(std::max(0.0, track.first_seen));
  message.last_seen.fromSec(std::max(0.0, track.last_seen));
  return message;
}

messages::DetectionArrayPtr detectionsOf(const TrackingOutcome& outcome, const Pose& camera_from_fixed,
                                         const std_msgs::Header& header) {
  const auto message = boost::make_shared<messages::DetectionArray>();
  message->header = header;
  for (const Track& track : outcome.tracks) {
    if (track.state == TrackState::kDoubtful || track.state == TrackState::kOutOfView) continue;
    messages::Detection detection;
    detection.object = track.object;
    detection.instance = static_cast<std::uint32_t>(track.instance);
    detection.accepted = 1;
    setPose(track, camera_from_fixed, &detection.pose);
    detection.confidence = track.confidence;
    detection.visible = track.visible;
    detection.state = trackStateName(track.state);
    const bool is_new = std::any_of(outcome.found.begin(), outcome.found.end(), [&](const Track& found) {
      return found.object == track.object && found.instance == track.instance;
    });
    detection.source = is_new ? sourceName(track.source) : "track";
    message->detections.push_back(detection);
  }
  std::stable_sort(message->detections.begin(), message->detections.end(),
                   [](const auto& a, const auto& b) { return a.confidence > b.confidence; });
  return message;
}

}  // namespace recognition
