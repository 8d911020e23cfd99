#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <tf2_ros/transform_listener.h>

#include "ros/detection_output.h"
#include "rgbd_recognition/ros/message_conversions.h"
#include "ros/frame_names.h"
#include "ros/parameters.h"
#include "ros/stage_nodelet.h"
#include "rgbd_recognition/tracking/tracker.h"

namespace recognition {
namespace {

constexpr char kFixedFrame[] = "fixed_frame";
constexpr char kCameraFrame[] = "camera_frame";
using RowMajor6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

constexpr double kPatience = 0.1;  // s: how late tf may be

messages::Track toMessage(const Track& track) {
  messages::Track message;
  message.object = track.object;
  message.instance = static_cast<std::uint32_t>(track.instance);
  message.pose.pose = poseMessage(track.fixed_from_object);
  Eigen::Map<RowMajor6d>(message.pose.covariance.data()) = track.covariance;
  message.confidence = track.confidence;
  message.detections = static_cast<std::uint32_t>(track.detections);
  message.last_seen.fromSec(track.last_seen);
  return message;
}

std::vector<messages::Track> toMessages(const std::vector<Track>& tracks) {
  std::vector<messages::Track> out;
  for (const Track& track : tracks) out.push_back(toMessage(track));
  return out;
}

}  // namespace

/// Optional stage after the pipeline: follows `detections` in `~fixed_frame` (the frame they come in if empty) and
/// publishes `tracks`. `~camera_frame` is the camera's optical frame, for detections that come in another one.
class TrackingNodelet : public StageNodelet {
 private:
  void configure() override {
    TrackingParameters parameters;
    std::vector<std::string> others = stageParameterNames();
    others.insert(others.end(), {kFixedFrame, kCameraFrame});
    readParameters(getPrivateNodeHandle(), parameters.list(), others);
    tracker_ = std::make_unique<Tracker>(parameters);
    fixed_frame_ = plainFrame(parameterOr(getPrivateNodeHandle(), kFixedFrame, fixed_frame_));
    camera_frame_ = plainFrame(parameterOr(getPrivateNodeHandle(), kCameraFrame, camera_frame_));
  }

  void advertise() override { tracks_ = advertiseLazy<messages::TrackArray>(getNodeHandle(), "tracks"); }

  void startInputs() override {
    // The listener has a thread of its own, as this nodelet's waits for it.
    if (!fixed_frame_.empty() || !camera_frame_.empty())
      listener_ = std::make_unique<tf2_ros::TransformListener>(buffer_);
    detections_ = getNodeHandle().subscribe("detections", 5, &TrackingNodelet::follow, this);
  }

  void stopInputs() override {
    detections_.shutdown();
    listener_.reset();
  }

  void follow(const messages::DetectionArrayConstPtr& message) {
    const Stopwatch watch;
    try {
      const std_msgs::Header& header = message->header;
      const Pose fixed_from_message = inFixedFrame(header.frame_id, header);
      const Pose fixed_from_camera = camera_frame_.empty() ? fixed_from_message : inFixedFrame(camera_frame_, header);
      messages::DetectionArray detections = *message;
      changeFrame(fixed_from_message, fixedFrame(header), &detections);
      const TrackingOutcome outcome =
          tracker_->update(header.stamp.toSec(), accepted(detections), fixed_from_camera);
      if (outcome.restarted) NODELET_WARN("time went backwards: all tracks begin anew");
      publish(outcome, header);
      processed(header, watch.seconds());
    } catch (const std::exception& error) {
      reject(detections_.getTopic(), error.what());
    }
  }

  /// Throws tf2::TransformException: unknown frame, or no transform for that time.
  Pose inFixedFrame(const std::string& frame, const std_msgs::Header& header) const {
    const std::string fixed = fixedFrame(header);
    if (plainFrame(frame) == fixed) return Pose::Identity();
    return poseFromMessage(
        buffer_.lookupTransform(fixed, plainFrame(frame), header.stamp, ros::Duration(kPatience)).transform);
  }

  std::string fixedFrame(const std_msgs::Header& header) const {
    return fixed_frame_.empty() ? plainFrame(header.frame_id) : fixed_frame_;
  }

  /// `message` in the fixed frame.
  static std::vector<TrackedDetection> accepted(const messages::DetectionArray& message) {
    std::vector<TrackedDetection> detections;
    for (const messages::Detection& detection : message.detections) {
      if (!detection.accepted) continue;
      const bool finite = std::all_of(detection.pose.covariance.begin(), detection.pose.covariance.end(),
                                      [](double value) { return std::isfinite(value); });
      if (!finite) throw std::invalid_argument(detection.object + " has a covariance that is not finite");
      if (!(detection.confidence >= 0.0f && detection.confidence <= 1.0f))
        throw std::invalid_argument(detection.object + " has confidence " + std::to_string(detection.confidence));
      detections.push_back({detection.object, poseFromMessage(detection.pose.pose),
                            Eigen::Map<const RowMajor6d>(detection.pose.covariance.data()), detection.confidence});
    }
    return detections;
  }

  void publish(const TrackingOutcome& outcome, const std_msgs::Header& header) const {
    const auto message = boost::make_shared<messages::TrackArray>();
    message->header = header;
    message->header.frame_id = fixedFrame(header);
    message->tracks = toMessages(outcome.tracks);
    message->found = toMessages(outcome.found);
    message->lost = toMessages(outcome.lost);
    tracks_.publish(message);
  }

  std::unique_ptr<Tracker> tracker_;
  std::string fixed_frame_, camera_frame_;
  tf2_ros::Buffer buffer_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
  ros::Subscriber detections_;
  ros::Publisher tracks_;
};

}  // namespace recognition

PLUGINLIB_EXPORT_CLASS(recognition::TrackingNodelet, nodelet::Nodelet)
