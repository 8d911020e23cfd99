#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {

/// A part of a frame as a frame of its own, without segments and features: CIELAB is computed there only.
class SceneCrop {
 public:
  /// `box`: in the depth image, of even place and size.
  SceneCrop(const RgbdFrame& frame, const cv::Rect& box);
  SceneCrop(const SceneCrop&) = delete;
  SceneCrop& operator=(const SceneCrop&) = delete;

  const cv::Rect& box() const { return box_; }
  const SceneView& view() const { return view_; }

 private:
  cv::Rect box_;
  Segmentation segmentation_;
  SceneFeatures features_;
  SceneView view_;
};

/// Where a model lies in the depth image at a pose, grown by `margin` pixels, to even place and size; empty where
/// nothing of it is in the image.
cv::Rect modelBox(const PreparedModel& model, const Pose& camera_from_object, const CameraModel& depth_camera,
                  int margin);

}  // namespace recognition
