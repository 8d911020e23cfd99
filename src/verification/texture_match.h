#pragma once

#include <opencv2/core.hpp>

#include "core/point_grid.h"
#include "rgbd_recognition/model/object_model.h"
#include "alignment/depth_buffer.h"
#include "alignment/scene_view.h"

namespace recognition {

/// Largest distance, metres, between a model feature and the place where the scene feature that shows it is seen.
constexpr float kTextureReach = 0.012f;

/// How much of the texture that is seen is the object's: the scene's features on a reprojected model, and how many of
/// them the model has at that very place. Unlike the consensus it does not ask how the hypothesis came about, and it
/// knows how many features ought to have agreed.
struct TextureMatch {
  int features = 0;  ///< scene features where model and scene agree in depth
  int matched = 0;   ///< of these, those that resemble a feature of the model within kTextureReach
};

/// `grid` holds the places of `model`, in cells of kTextureReach or wider; `state` is PixelState over the box of
/// `reprojected`.
TextureMatch matchTexture(const ModelFeatures& model, const PointGrid& grid, const Pose& camera_from_object,
                      const ReprojectedModel& reprojected, const cv::Mat& state, const SceneView& scene);

}  // namespace recognition
