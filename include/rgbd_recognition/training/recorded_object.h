#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/core/parameters.h"
#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/features/feature_parameters.h"
#include "rgbd_recognition/training/training_parameters.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/training/training_progress.h"
#include "rgbd_recognition/training/fiducial_board.h"

namespace recognition {

/// One frame of a recording of an object.
///
/// The world is a frame that stands still with respect to the object: the fiducial board's, or that of
/// `camera_from_world` (a table, a turntable, the object itself). Without a mask, the object stands on the world's
/// plane z = 0, z up, near the origin.
struct RecordedView {
  RgbdFrame frame;
  std::optional<Pose> camera_from_world;  ///< where there is no board
  cv::Mat
      mask;  ///< CV_8UC1, depth resolution: 255 on the object; empty: the object is cut out of what stands above z = 0
};

/// How models are trained from recordings.
struct RecordingParameters {
  double view_angle = 8.0;  ///< least angle between two views that are used, degrees
  int max_views = 100;
  double plane_margin = 0.006;       ///< what is lower above the board belongs to the board, metres
  double max_radius = 0.3;           ///< of the region around the board's middle in which the object stands, metres
  double max_height = 0.6;           ///< metres
  int alignment_rounds = 3;          ///< of the views' poses with the cloud that all of them make
  double alignment_distance = 0.01;  ///< farthest pairing, metres
  double pose_sigma = 0.002;         ///< how far a board's pose is trusted, metres; and at 0.2 m from it, as an angle
  double point_spacing = 0.003;      ///< of the cloud P, metres
  int min_views = 2;                 ///< that must agree on a point of the cloud, where so many views look
  double scale_tolerance = 0.03;     ///< largest deviation between the board's size by depth and by description
  double feature_distance = 0.006;   ///< farthest place of a feature from the cloud, metres
  double far_distance = 1.8;  ///< farthest at which features are learnt, metres: from shrunk images, as from a mesh
  int distances = 3;          ///< in geometric steps from the camera's own distance to that
  MergingParameters merging = {0.004, 0.08, 1.4, 0.3, 6000};

  ParameterList list();
  void validate() const;
};

/// How good a training was.
struct TrainingReport {
  int views_used = 0;
  int views_seen = 0;
  std::vector<std::string> refused;  ///< reasons, one a view that could not be used
  double coverage =
      0.0;  ///< share of the upper half of all directions from which the object was seen, within 20 degrees
  double board_rms = 0.0;             ///< pixels, mean over views; 0 without board
  double residual = 0.0;              ///< median distance of the views' points from the cloud after alignment, metres
  double board_spread = 0.0;          ///< of the board's distance by depth over that by its pose, within one view
  double carved = 0.0;                ///< share of what was measured that other views see through: dropped
  double overexposed = 0.0;           ///< share of the object's pixels that are too bright for the camera
  std::vector<std::string> warnings;  ///< for people: what the model will be bad at
};

/// Makes a model from views of a real object. Poses come from the board, or are given. The object is cut out, poses are
/// refined over all views, clouds fused, features merged. It keeps the views that it uses. One thread at a time.
class RecordedObject {
 public:
  /// `world_from_object` is the frame of the model. Without it, the model has the world's orientation, and its origin
  /// is the object's middle on the board, or the mask's centroid.
  RecordedObject(const RecordingParameters& parameters, const FeatureParameters& features,
                 std::optional<FiducialBoard> board, std::optional<Pose> world_from_object = std::nullopt);
  ~RecordedObject();

  /// Takes one more view. Empty if it is used, else the reason why not (no board in view, too near to a view already
  /// used, enough views, a frame that does not fit).
  std::string add(const RecordedView& view);
  /// Counts a view that could not even be read.
  void refuse(const std::string& reason);

  int views() const;
  /// Directions (world frame, unit) from which the object was seen so far, for a picture of the coverage.
  std::vector<Eigen::Vector3f> viewDirections() const;

  /// Share of the upper half of all directions that lies within 20 degrees of those.
  double coverage() const;
  /// Pose camera_from_world of the view given last, used or not; nothing if it was not found.
  const std::optional<Pose>& lastPose() const;
  /// A quick cloud of the views so far for a picture, in the world's frame; empty where there is no object yet.
  std::vector<SurfacePoint> roughCloud() const;

  struct Result {
    ObjectModel model;
    TrainingReport report;
  };
  /// The model with features of each of `types`. Throws std::runtime_error with the reason: no view, nothing above the
  /// board, wrong board size, depth that is not registered to colour, an object that moved or is larger than the board,
  /// given poses that do not fit.
  /// What `progress` throws ends it.
  Result build(const std::string& name, const std::vector<DescriptorType>& types,
               const TrainingProgress& progress = nullptr);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
