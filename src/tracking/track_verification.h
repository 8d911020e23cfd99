#pragma once

#include <memory>
#include <optional>

#include <opencv2/core.hpp>

#include "alignment/depth_buffer.h"
#include "alignment/pose_refiner.h"
#include "alignment/prepared_model.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/verification/verification_parameters.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"
#include "tracking/scene_crop.h"

namespace recognition {

/// What the depth image says of a model at a pose: shares of its pixels there, which add up to 1.
struct DepthShares {
  double consistent = 0.0;
  double hidden = 0.0;      ///< something nearer
  double free_space = 0.0;  ///< the scene is seen through it
  double unknown = 0.0;     ///< holes
  int pixels = 0;           ///< in the image, at half resolution
  double outside = 1.0;     ///< share of its near side outside the image; not one of those above
};

/// A mask (CV_8UC1, 255) of a part of the depth image.
struct ImagePart {
  cv::Rect box;
  cv::Mat mask;
};

/// The test of one followed object in one frame, by the levels of a detection's test, on the part of the frame where it
/// may be. Its features are not looked for: what they said of the detection stays as evidence.
class TrackVerification {
 public:
  /// References must outlive it. `camera_from_object`: where it is expected.
  TrackVerification(const PreparedModel& model, const ObjectModel& object, const VerificationParameters& parameters,
                    const RgbdFrame& frame, const Pose& camera_from_object);

  /// The shares at the pose, as it is now.
  DepthShares look() const;
  /// Mean lightness (CIELAB L) of the frame where the model is not hidden, as it is now.
  double lightness() const;

  /// From several places beside the pose takes the one that the frame's depth and colours fit best: for what moved by
  /// more than was expected.
  void searchAround();
  /// Draws the pose to the frame; again, while its colours agree less than usual, and better each time. False, and the
  /// pose stays, where too little of the model is in the depth.
  bool align(bool use_lightness, double usual_colors);

  /// At half resolution, with a quarter of the points.
  Appearance compareCoarsely() const;
  /// All evidence that pixels give, at full resolution; Evidence::peak too.
  Evidence compare() const;
  /// Where the frame agrees with the model or has a hole, grown by some pixels.
  ImagePart explained() const;

  const Pose& pose() const { return pose_; }
  /// As of Refinement.
  const Matrix6d& covariance() const { return covariance_; }
  const Matrix6d& frameNoise() const { return frame_noise_; }
  /// Correlation of the model's colours with the frame's at the pose, if lightness was used.
  double colors() const { return colors_; }

 private:
  /// The model at the pose at half resolution, and PixelState of its pixels.
  struct Coarse {
    ReprojectedModel seen;
    cv::Mat state;
  };

  const SceneView& view() const { return crop_->view(); }
  const Coarse& coarse() const;
  cv::Mat shown() const;
  double fitOf(const Pose& pose) const;
  double colorsOf(const Pose& pose) const;

  const PreparedModel& model_;
  const ObjectModel& object_;
  const VerificationParameters& parameters_;
  const RgbdFrame& frame_;
  Pose pose_;
  Matrix6d covariance_ = Matrix6d::Zero(), frame_noise_ = Matrix6d::Zero();
  double colors_ = 0.0;
  std::unique_ptr<SceneCrop> crop_;       // null: out of view
  mutable std::optional<Coarse> coarse_;  // of the pose as it is
};

}  // namespace recognition
