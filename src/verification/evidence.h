#pragma once

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"
#include "verification/pixel_consistency.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"

namespace recognition {

/// Different scene features of the consensus that lie within `max_distance` metres and `max_pixels` (depth pixels) of
/// the model's at this pose.
int countInliers(const Hypothesis& hypothesis, const ObjectModel& object, const Pose& camera_from_object,
                 const SceneView& scene, double max_distance, double max_pixels);

/// Sizes of the comparison in pixels: half of them at half resolution.
struct AppearanceScale {
  int rim = 2;     ///< of M_j's outline left out, where half a pixel of pose error shows the background
  int window = 7;  ///< radius of the local correlation

  static AppearanceScale ofHalf() { return {1, 3}; }
};

/// The illumination under which the frame shows the model: fitColorTransform() over the consistent, unclipped pixels.
ColorTransform fitIllumination(const ReprojectedModel& reprojected, const cv::Mat& state, const ModelCloud& model,
                               const SceneView& scene, const AppearanceScale& scale = {});

/// Evidence::segment_share. `step`: depth pixels a pixel of `state`, 2 at half resolution.
double segmentShare(const cv::Mat& state, const cv::Rect& box, const Segmentation& segmentation, int step = 1);

/// What colour says: structure, texture, distances, depth fit and gain of Evidence.
Evidence weighAppearance(const ReprojectedModel& reprojected, const PixelConsistency& pixels,
                         const ModelCloud& model, const ColorTransform& illumination, const SceneView& scene,
                         const AppearanceScale& scale = {});

}  // namespace recognition
