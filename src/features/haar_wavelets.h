#pragma once

#include <vector>

#include "integral_image.h"

namespace rgbd_recognition {

/// Responses of Haar wavelets (Fig. 8 of Bay et al.) at many places of one integral image.
struct HaarSamples {
  std::vector<float> x, y;            ///< in: places, pixels of the integral image
  std::vector<float> dx, dy;          ///< out: right minus left half, lower minus upper half
  std::vector<std::int32_t> base;     ///< scratch: corner of the integral image
  std::vector<float> fx, fy, inside;  ///< scratch

  void resize(size_t n);

  /// Wavelets of side 2 `half`, at fractional places (the responses are interpolated, which is exact for the image as a
  /// field of squares). 0 for a wavelet that does not lie inside the image.
  void evaluate(const IntegralImage& image, int half);
};

}  // namespace rgbd_recognition
