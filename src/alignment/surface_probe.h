#pragma once

#include "rgbd_recognition/core/pose.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"

namespace recognition {

/// What a frame says of a pose at a first look.
struct ProbeResult {
  int facing = 0;            ///< points that face the camera
  double agreeing = 0.0;     ///< share of these where the frame has about their depth
  double free_space = 0.0;   ///< share of these through which the scene is seen
  double outside = 0.0;      ///< share of these that lie outside the image
  double correlation = 0.0;  ///< of the model's CIELAB colours with the frame's where depth does not contradict, -1..1;
                             ///< 0 if there are too few
};

/// What is worth comparing in colour.
struct ProbeLimits {
  double agreeing = 0.0;    ///< at least
  double free_space = 1.0;  ///< at most
  /// Whether pixels that the camera clips do not count where the model is bright.
  bool drops_clipped = false;

  bool hold(const ProbeResult& result) const { return result.agreeing >= agreeing && result.free_space <= free_space; }
};

/// Looks at the first `points` of PreparedModel::probe_points that face the camera: coarse (a point that another one
/// hides counts too), some microseconds. Stops early where most of the first ones are free space. Outside the limits
/// no correlation is made.
ProbeResult probeSurface(const PreparedModel& model, int points, const Pose& camera_from_object, const SceneView& scene,
                         const ProbeLimits& limits = {});

/// Draws a pose to the frame's depth: point to plane, with the same points; a rough refinePose() for many poses. The
/// pose given where too few points are near any depth.
Pose alignToDepth(const PreparedModel& model, int points, const Pose& camera_from_object, const SceneView& scene);

}  // namespace recognition
