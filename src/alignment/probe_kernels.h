#pragma once

#include <Eigen/Geometry>

#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "alignment/weighted_rows.h"

namespace recognition {

constexpr int kProbeBlock = 128;  ///< points that are looked at together

/// A pose and the frame it is looked at in; coordinates in the camera's optical frame.
struct ProbeView {
  float rotation[9], translation[3];  ///< row by row
  float fx, fy, cx, cy;
  const float* depth;
  int cols, rows, stride;  ///< stride in elements

  ProbeView(const SceneView& scene, const Eigen::Isometry3f& camera_from_object);
};

constexpr float kTurnedAway = -2.0f, kOutsideView = -1.0f;  ///< instead of a depth

/// Points as a pose puts them into the frame, and what the frame has there.
struct ProbeLooks {
  alignas(64) float position[3][kProbeBlock];
  alignas(64) float normal[3][kProbeBlock];
  alignas(64) float column[kProbeBlock], row[kProbeBlock];  ///< of the pixel, whole numbers
  alignas(64) float depth[kProbeBlock];  ///< metres; 0: unknown; kOutsideView; kTurnedAway from the camera or behind it
};

/// Looks at `count` points (at most kProbeBlock) from `first` on.
void lookAt(const ProbeView& view, const ProbePoints& points, int first, int count, ProbeLooks* looks);

/// Sums of point-to-plane distances, robustly weighted, for one Gauss-Newton step.
struct PlaneSums {
  RowSums<6> equations;  ///< of translation, then rotation about the anchor
  int used;
};

/// Of the first `count` looks those whose depth is within twice the `gate` (metres) of the point's.
PlaneSums sumPlanes(const ProbeView& view, const ProbeLooks& looks, int count, const float* anchor, float gate);

}  // namespace recognition
