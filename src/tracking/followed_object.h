#pragma once

#include <deque>
#include <memory>

#include "alignment/prepared_model.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/tracking/track.h"
#include "rgbd_recognition/tracking/tracking_parameters.h"
#include "rgbd_recognition/verification/verification_parameters.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"
#include "tracking/pose_filter.h"
#include "tracking/track_verification.h"

namespace recognition {

/// A frame as tracks see it.
struct FrameInTime {
  double stamp = 0.0;  ///< seconds
  const RgbdFrame& frame;
  Pose fixed_from_camera = Pose::Identity();
};

/// What all tracks are tested with.
struct TrackingContext {
  TrackingParameters tracking;
  VerificationParameters verification;
  std::shared_ptr<const PreparedModels> models;
};

/// What one frame says of one track.
struct Sight {
  TrackState state = TrackState::kDoubtful;
  TrackEnd doubt = TrackEnd::kNotSeen;  ///< what it would be given up for, where doubtful
  bool measured = false;                ///< `fixed_from_object` is the frame's
  Pose fixed_from_object = Pose::Identity();
  Matrix6d covariance = Matrix6d::Zero(), frame_noise = Matrix6d::Zero();  ///< as of Refinement, fixed frame
  DepthShares shares;
  double colors = 0.0;            ///< correlation of the model's with the frame's
  double lightness = 0.0;         ///< CIELAB L
  double coarse_structure = 0.0;  ///< Evidence::structure at half resolution
  bool compared = false;          ///< at full resolution, and
  Evidence evidence;              ///< this is what came out
  double confidence = 0.0;        ///< by that evidence
  ImagePart explained;            ///< where seen
};

/// One object that is followed: its pose over time, what it usually looks like, and since when frames contradict.
class FollowedObject {
 public:
  /// `detection` in the frame of `stamp`, whose pose in the fixed frame is given.
  FollowedObject(const VerifiedHypothesis& detection, const ObjectModel& object, const PreparedModel& model,
                 const Pose& fixed_from_object, double stamp);

  /// Looks for it in a frame where it is expected, or at `at` (fixed frame). Changes nothing.
  Sight look(const FrameInTime& frame, const TrackingContext& context, const Pose* at = nullptr) const;
  /// Takes what look() gave for the frame of that stamp; track.end tells if it is given up with that.
  void take(const Sight& sight, double stamp, const TrackingParameters& parameters);
  /// As take(), with a pose that the filter is set to: the sight of a place that turned out to be the right one.
  void jumpTo(const Sight& sight, double stamp, const TrackingParameters& parameters);
  /// A detection agreed: what features say of it is new.
  void confirm(const VerifiedHypothesis& detection, const TrackingParameters& parameters);

  /// Where it was at a stamp, or nearest to it, as far as that is kept.
  Pose placeAt(double stamp) const;
  Pose place() const { return filter_.pose(); }
  Eigen::Vector3d centre() const { return place() * centre_; }
  /// How much it explains, weighted by how little doubt is left, as selection does.
  double strength() const;
  bool looksRight(const Sight& sight) const;

  Track track;
  Evidence evidence;    ///< of features by the last detection, of pixels by the last comparison
  ImagePart explained;  ///< of the last frame; empty where it was not seen

 private:
  struct Place {
    double stamp;
    Pose fixed_from_object;
  };

  void judge(const TrackVerification& test, const FrameInTime& frame, const TrackingContext& context,
             Sight* sight) const;
  void learn(const Sight& sight);
  void updateConfidence(const Sight& sight, double seconds);
  TrackEnd endBy(const Sight& sight, double stamp, const TrackingParameters& parameters);

  Eigen::Vector3d centre_;  // object frame
  PoseFilter filter_;
  std::deque<Place> places_;
  double stamp_;                   // of the last frame
  double compared_ = -1.0;         // stamp of the last comparison at full resolution
  bool fitted_ = false;            // by the last comparison at full resolution; in doubt each frame is compared
  double frame_confidence_ = 0.0;  // of it
  double usual_colors_ = 1.0;      // correlation; 1 before any is known
  double usual_coarse_ = 0.0, usual_structure_ = 0.0, usual_lightness_ = 0.0;  // 0: not known yet
  double doubtful_since_ = -1.0;                                               // stamps; negative: it is not
  double unseen_since_ = -1.0;
};

}  // namespace recognition
