#pragma once

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/segmentation/segmentation.h"

namespace recognition {

/// The colour image (BGR) with each patch tinted, large planes darkened, and edges drawn (jump red, convex crease
/// green, concave crease blue).
cv::Mat segmentOverlay(const RgbdFrame& frame, const Segmentation& segmentation);

}  // namespace recognition
