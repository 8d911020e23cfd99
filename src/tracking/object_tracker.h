#pragma once

#include <deque>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/tracking/track.h"
#include "tracking/followed_object.h"

namespace recognition {

/// Follows detected objects from frame to frame, so that each frame has poses while detection still works on an earlier
/// one. Each track is predicted, drawn to the frame by the refinement that detections have, and tested by their
/// evidence; see FollowedObject. Same frames and detections at the same time, same tracks, for any number of threads.
/// Not for concurrent use.
class ObjectTracker {
 public:
  /// Throws std::invalid_argument as the parameters' validate() does.
  ObjectTracker(const TrackingParameters& parameters, const VerificationParameters& verification,
                std::shared_ptr<const PreparedModels> models);
  ~ObjectTracker();

  /// What detection found in the frame of that stamp (accepted ones only, camera's frame): the next frame takes it,
  /// brought there by the camera's motion and, where another track's motion fits it better, by that one.
  void add(double stamp, std::vector<VerifiedHypothesis> detections);

  /// Follows all tracks into a frame. A frame of the last stamp, or a little older, is ignored; one that is older by
  /// more than `clock_step` gives all tracks up and begins anew. `fixed_from_camera`: where the camera was; the identity
  /// throughout if nobody knows. Throws std::invalid_argument for a frame that does not fit.
  TrackingOutcome follow(double stamp, const RgbdFrame& frame, const Pose& fixed_from_camera = Pose::Identity());

  /// CV_8UC1, depth resolution: where tracks explain the last frame's pixels (explained_pixels.h). Empty before the
  /// first.
  const cv::Mat& explained() const { return explained_; }

  /// Other models: tracks go on by name; those without a model are given up with the next frame.
  void setModels(std::shared_ptr<const PreparedModels> models);

  /// Detections that no present frame showed any more, and results that waited for a frame too long.
  int dropped() const { return dropped_; }

  const TrackingParameters& parameters() const { return context_.tracking; }

 private:
  struct Result {
    double stamp;
    std::vector<VerifiedHypothesis> detections;
  };
  struct CameraPlace {
    double stamp;
    Pose fixed_from_camera;
  };

  void restart(TrackingOutcome* outcome);
  void followAll(const FrameInTime& frame);
  void take(const Result& result, const FrameInTime& frame);
  std::vector<FollowedObject*> partners(const Result& result, const Pose& fixed_from_camera);
  void compare(const VerifiedHypothesis& detection, const Pose& then, double stamp, const FrameInTime& frame,
               FollowedObject* track);
  void begin(const VerifiedHypothesis& detection, const Pose& then, double stamp, const FrameInTime& frame);
  Pose cameraAt(double stamp) const;
  void resolveOverlaps();
  void collect(const std::vector<const FollowedObject*>& before, TrackingOutcome* outcome);
  void explain(cv::Size size);
  int freeInstance(const std::string& object) const;

  TrackingContext context_;
  std::vector<std::unique_ptr<FollowedObject>> followed_;
  std::vector<Track> ended_;  // confirmed ones, that no outcome told yet
  std::deque<Result> waiting_;
  std::deque<CameraPlace> camera_;
  cv::Mat explained_;
  double stamp_ = 0.0;
  bool started_ = false;
  int dropped_ = 0;
};

}  // namespace recognition
