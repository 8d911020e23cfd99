#pragma once

#include <cstdint>
#include <vector>

#include "features/integral_image.h"

namespace recognition {

/// Offsets of samples from a keypoint, in units of its scale s.
struct SampleOffsets {
  std::vector<float> x, y;

  void add(float offset_x, float offset_y) {
    x.push_back(offset_x);
    y.push_back(offset_y);
  }
};

/// Responses of Haar wavelets (Fig. 8 of Bay et al.) at many places of an integral image. Keeps its buffers; one a
/// thread.
class HaarSampler {
 public:
  /// Places the samples: (x, y) + [c -s; s c] offset, pixels of the integral image.
  void place(float x, float y, float c, float s, const SampleOffsets& offsets);

  /// Wavelets of side 2 `half` at the places, 0 for one that does not lie inside the image. Small wavelets are
  /// interpolated between whole pixels, where rounding would move them by a good part of their size; large ones are
  /// taken at the nearest.
  void evaluate(const IntegralImage& image, int half);

  const std::vector<float>& dx() const { return dx_; }  ///< right minus left half, gray levels times pixels
  const std::vector<float>& dy() const { return dy_; }  ///< lower minus upper half

 private:
  void evaluateNearest(const IntegralImage& image, int half);
  void evaluateInterpolated(const IntegralImage& image, int half);

  std::vector<float> x_, y_, dx_, dy_;
  std::vector<float> dense_dx_, dense_dy_;  // of each corner in the samples' bounding box
  std::vector<std::uint32_t> band_;
};

}  // namespace recognition
