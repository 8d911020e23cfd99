#pragma once

#include <functional>
#include <vector>

#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "alignment/surface_probe.h"

namespace recognition {

/// Poses beside a pose, in which the visible surface lies about where it lies, but its texture does not: slid along the
/// mean plane of what faces the camera by 20 mm (four directions), and rotated about its normal by 20 degrees. Evidence
/// that is as good there is no evidence for the pose.
std::vector<Pose> controlPoses(const PreparedModel& model, const Pose& camera_from_object);

/// Correlation of the colours of `points` points of the model with the frame's, less the best of the control poses'.
/// `limits` as probeSurface() takes them; `hopeless` is asked after each control, which can only lower the peak: where it says so, the others are left out.
double colorPeak(const PreparedModel& model, int points, const Pose& camera_from_object, const SceneView& scene,
                 const ProbeLimits& limits = {}, const std::function<bool(double peak)>& hopeless = nullptr);

}  // namespace recognition
