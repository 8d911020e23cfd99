#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/tracking/tracking_parameters.h"

namespace recognition {

/// What one frame says about one object. Poses and covariances are in the fixed frame; covariances are of the object's
/// origin (x y z, metres) and of the rotation about it (x y z, radians).
struct TrackedDetection {
  std::string object;
  Pose fixed_from_object = Pose::Identity();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();
  double confidence = 0.0;  ///< 0..1
};

/// An object followed over frames.
struct Track {
  std::string object;
  int instance = 0;  ///< among the tracks of this object, from 0; stays for as long as the track lives
  Pose fixed_from_object = Pose::Identity();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();
  double confidence = 0.0;  ///< of its detections and misses together, 0..1
  int detections = 0;
  double last_seen = 0.0;  ///< stamp of the last detection, seconds
  bool confirmed = false;
};

/// News of one frame.
struct TrackingOutcome {
  std::vector<Track> tracks;  ///< the confirmed ones, by object and instance
  std::vector<Track> found;   ///< confirmed by this frame
  std::vector<Track> lost;    ///< given up with this frame, of those that were confirmed
  bool restarted = false;     ///< time went backwards: all tracks were dropped
};

/// Follows detections over frames in a fixed frame, so that views of a moving camera add up: a Kalman filter a track
/// (objects stand still but for a slow drift), nearest detection first, instance numbers that stay. An object that was
/// moved or that had been taken for another turn gets its new pose once `confirm_frames` detections agree on it.
/// A track that is out of the camera's view is not missed.
class Tracker {
 public:
  /// Throws std::invalid_argument as TrackingParameters::validate() does.
  explicit Tracker(const TrackingParameters& parameters);

  /// `stamp` in seconds; `fixed_from_camera` tells which tracks are in view. Detections of one frame must be different
  /// instances.
  TrackingOutcome update(double stamp, const std::vector<TrackedDetection>& detections, const Pose& fixed_from_camera);

  const TrackingParameters& parameters() const { return parameters_; }

 private:
  struct Followed {
    Track track;
    double missed = 0.0;        // seconds in view since it was last seen
    double absent = 0.0;        // seconds since it was last seen
    int contradictions = 0;     // detections in a row at its place but turned
  };

  void predict(double stamp, const Pose& fixed_from_camera);
  std::vector<bool> associate(double stamp, const std::vector<TrackedDetection>& detections, TrackingOutcome* outcome);
  void take(const TrackedDetection& detection, double stamp, Followed* followed, TrackingOutcome* outcome);
  void start(const TrackedDetection& detection, double stamp, TrackingOutcome* outcome);
  void dropLost(TrackingOutcome* outcome);
  bool inView(const Pose& camera_from_object) const;
  int freeInstance(const std::string& object) const;

  TrackingParameters parameters_;
  double stamp_ = 0.0;
  bool started_ = false;
  std::vector<Followed> followed_;
};

}  // namespace recognition
