#pragma once

#include <opencv2/core.hpp>

#include "alignment/depth_buffer.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// Largest distance, metres, between a model feature and the place where the scene feature that shows it is seen.
constexpr float kTextureReach = 0.012f;

/// How much of the texture that is seen is the object's: the scene's features on a reprojected model, and how many of
/// them the model has at that very place. Unlike the consensus it does not ask how the hypothesis came about, and it
/// knows how many features ought to have agreed.
struct TextureMatch {
  int features = 0;           ///< scene features where model and scene agree in depth
  int matched = 0;            ///< of these, those that resemble a feature of the model within kTextureReach
  int best_control = 0;       ///< largest number that matches at one of the control poses
  double significance = 0.0;  ///< log-likelihood ratio of `matched` against `best_control`, nats; see significanceOf()
};

/// Scene and model features are compared in the image: of the model's features that face the camera those within
/// kTextureReach of the scene feature's pixel, of about its size and orientation. The control poses slide the model's
/// texture by 30 and 45 mm across the image and rotate it by 60 degrees about its middle: texture that repeats,
/// and edges that are the same anywhere along them, match there as well and count for nothing.
///
/// `state` is PixelState over the box of `reprojected`.
TextureMatch matchTexture(const ModelFeatures& model, const Pose& camera_from_object,
                          const ReprojectedModel& reprojected, const cv::Mat& state, const SceneView& scene);

/// Log-likelihood ratio (nats, not below 0) of `matched` out of `features` under the rate that is observed there
/// against the rate at the control poses, of which `best_control` matched.
double significanceOf(int features, int matched, int best_control);

}  // namespace recognition
