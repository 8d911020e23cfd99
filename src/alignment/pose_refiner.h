#pragma once

#include <Eigen/Core>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/model/object_model.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"

namespace recognition {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

struct Refinement {
  Pose camera_from_object = Pose::Identity();
  /// Of the object's origin (x y z, metres) and of the rotation about it (x y z, radians), in the camera's axes: with
  /// what is off alike in all frames, as the scale of depth, and without a bound to what nothing determines, as the
  /// rotation of a blank can.
  Matrix6d covariance = Matrix6d::Zero();
  Matrix6d frame_noise = Matrix6d::Zero();  ///< likewise, but of the noise alone, bounded by a step; if asked for
  int iterations = 0;
  bool success = false;  ///< enough of the model was found in the depth; if not, the pose is the one given
};

/// Iterations and what they weigh.
struct RefinementOptions {
  int iterations = 12;
  size_t samples = 450;       ///< points of the model, at most
  bool use_features = true;   ///< hold the consensus set in place: flat faces and cans do not slide
  bool use_lightness = true;  ///< align the texture
  int lightness_from = 3;     ///< iteration; earlier where the pose is nearly right already
  bool wants_frame_noise = false;
  double max_step = 0.03, max_turn = 0.3;  ///< metres and radians: deviations of a prior that keeps each step small
};

/// Gauss-Newton over robust residuals, each divided by its noise: point to plane against the depth (projective
/// association with the points that the depth buffer shows, the sensor's sigma(z)), the consensus set in space and in
/// the image, and lightness of the model as lit against the frame's. The paper tests the unrefined pose; this comes
/// before its test.
Refinement refinePose(const PreparedModel& model, const ObjectModel& object, const Hypothesis& hypothesis,
                      const Pose& camera_from_object, const SceneView& scene, const RefinementOptions& options);

}  // namespace recognition
