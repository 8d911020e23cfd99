#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "features/integral_image.h"
#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {

/// Fast-Hessian (Sec. 3 of Bay et al.): maxima of the determinant over place and scale, in pixels of the integral
/// image; no angle yet. Only what `mask` (of the original image; may be empty) holds is looked at.
std::vector<Keypoint> detectSurf(const IntegralImage& image, const cv::Mat& mask, const SurfParameters& parameters);

}  // namespace recognition
