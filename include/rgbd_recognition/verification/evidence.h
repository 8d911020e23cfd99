#pragma once

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/verification/consistency.h"

namespace rgbd_recognition {

/// What speaks for a hypothesis beside the paper's measures; the confidence is a function of both.
struct Evidence {
  int inliers = 0;  ///< different scene features of the consensus that agree with the pose, in space and in the image
  int features = 0;  ///< of a look-alike: scene features on the seen pixels, and
  int matched = 0;   ///< of these, those that the model has at that place, see matchPrint()
  double structure =
      0.0;  ///< local correlation of model's and frame's lightness over the seen pixels, weighted by contrast, -1..1
  double texture = 0.0;         ///< mean of those weights: 0 where neither has contrast, 1 where all is print
  double color_distance = 0.0;  ///< mean CIELAB distance left over the seen pixels, capped at 50
  double light_change = 0.0;    ///< mean change of chroma that the fitted light makes, CIELAB
  double depth_fit = 0.0;       ///< consistent pixels over consistent and seen-through ones, 0..1
  double seen = 0.0;            ///< consistent pixels, of M_j without its rim
  /// Mean over the pixels of consistent depth of the share of their segment (Sec. IV) that the hypothesis explains, 0
  /// for pixels in none: low where the model lies in a surface that goes on beyond it, as print on a table cloth makes
  /// it. s_o of eq. (14) for an object of several segments, and by depth alone, whatever the light.
  double segment_share = 0.0;
  /// Sum over the pixels of how well each is explained, -1..1: positive where model and frame agree, negative where the
  /// frame contradicts, 0 where it does not say.
  double gain = 0.0;
};

/// Different scene features of the consensus that lie within `max_distance` metres and `max_pixels` (depth pixels) of
/// the model's at this pose.
int countInliers(const Hypothesis& hypothesis, const ObjectModel& object, const Pose& camera_from_object,
                 const SceneView& scene, double max_distance, double max_pixels);

/// The light under which the frame shows the model: fitColorTransform() over the consistent, unclipped pixels.
ColorTransform fitLight(const ReprojectedModel& reprojected, const cv::Mat& state, const PreparedModel& model,
                        const SceneView& scene);

/// Evidence::segment_share.
double segmentShare(const cv::Mat& state, const cv::Rect& box, const Segmentation& segmentation);

/// All of Evidence but inliers, print and segment share. The rim of M_j, where half a pixel of pose error shows the
/// background, is left out.
Evidence weighAppearance(const ReprojectedModel& reprojected, const PixelConsistency& pixels,
                         const PreparedModel& model, const ColorTransform& light, const SceneView& scene);

}  // namespace rgbd_recognition
