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

/// A reprojected model beside the frame: what the measures below compare. Refers to its parts.
struct PosedModel {
  PosedModel(const ModelCloud& own_model, const ReprojectedModel& its_pixels, const cv::Mat& their_state,
             const SceneView& frame, const AppearanceScale& own_scale = {});

  const ModelCloud& model;
  const ReprojectedModel& reprojected;
  const cv::Mat& state;  ///< PixelState of each pixel of the box
  const SceneView& scene;
  AppearanceScale scale;
  cv::Mat inside;  ///< M_j without its rim, 255 or 0
};

/// Evidence::depth_fit and Evidence::seen.
struct DepthFit {
  double fit = 0.0, seen = 0.0;
};
DepthFit depthFit(const PosedModel& posed);

/// The illumination under which the frame shows the model: fitColorTransform() over the consistent, unclipped pixels.
ColorTransform fitIllumination(const PosedModel& posed);

/// The model as lit and the frame, over the model's box; `mask` is 1 where they are compared.
struct LitModel {
  cv::Mat color;                   ///< CV_32FC3, CIELAB
  cv::Mat lightness, scene, mask;  ///< CV_32FC1; the first two are blurred
};
LitModel lightModel(const PosedModel& posed, const ColorTransform& illumination);

/// What colour says.
Appearance weighAppearance(const PosedModel& posed, const ColorTransform& illumination);

/// Evidence::segment_share. `step`: depth pixels a pixel of `state`, 2 at half resolution.
double segmentShare(const cv::Mat& state, const cv::Rect& box, const Segmentation& segmentation, int step = 1);

}  // namespace recognition
