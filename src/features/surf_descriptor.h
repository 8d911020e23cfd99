#pragma once

#include "integral_image.h"
#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/features/surf.h"

namespace rgbd_recognition {

/// Orientation from Haar wavelet responses in a circle of 6 s, the longest sum in a sliding window of 60 degrees
/// (Sec. 4.1 of Bay et al.).
float surfOrientation(const IntegralImage& image, const Keypoint& keypoint);

/// Descriptor of 4 x 4 sub-regions of 5 x 5 Haar wavelet responses each (Sec. 4.2): sums of dx, dy, |dx|, |dy|, 64 in
/// all; `extended`, each split by the sign of the other derivative, 128 in all. Unit length, all zero where nothing
/// varies. `keypoint` in pixels of the integral image.
void surfDescriptor(const IntegralImage& image, const Keypoint& keypoint, bool extended, bool root, float* descriptor);

}  // namespace rgbd_recognition
