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

/// The illumination under which the frame shows the model: fitColorTransform() over the consistent, unclipped pixels.
ColorTransform fitIllumination(const ReprojectedModel& reprojected, const cv::Mat& state, const PreparedModel& model,
                        const SceneView& scene);

/// Evidence::segment_share.
double segmentShare(const cv::Mat& state, const cv::Rect& box, const Segmentation& segmentation);

/// All of Evidence but inliers, texture and segment share. The rim of M_j, where half a pixel of pose error shows the
/// background, is left out.
Evidence weighAppearance(const ReprojectedModel& reprojected, const PixelConsistency& pixels,
                         const PreparedModel& model, const ColorTransform& illumination, const SceneView& scene);

}  // namespace recognition
