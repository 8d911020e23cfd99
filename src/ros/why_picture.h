#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/segmentation/segmentation.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"

namespace recognition {

/// What recognition made of one frame.
struct FrameAnswer {
  const RgbdFrame& frame;
  const Segmentation& segmentation;
  const SceneFeatures& features;
  const std::vector<VerifiedHypothesis>& tested;
  const std::vector<VerifiedHypothesis>& found;
  const ModelDatabase& database;
};

/// Of each object the pose that came nearest to being accepted, the best first: of objects that were found only those
/// away from where they were.
std::vector<const VerifiedHypothesis*> bestRejected(const FrameAnswer& answer);

/// Why an object was found or not, at a glance (CV_8UC3, BGR): the frame with segments, features, what was found and the
/// nearest misses; below it a line for each object.
cv::Mat whyPicture(const FrameAnswer& answer);

}  // namespace recognition
