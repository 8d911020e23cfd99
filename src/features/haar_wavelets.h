#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
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

/// Larger wavelets, in pixels of the half side, are taken at the nearest place; smaller ones are interpolated, as
/// rounding would move them by a good part of their size.
constexpr int kMaxInterpolatedHalf = 4;

/// Responses of small Haar wavelets (Fig. 8 of Bay et al.) at every corner of an integral image. Windows of keypoints
/// overlap many times, so this costs less than each window's own responses. Keeps its buffers; one a thread.
class HaarResponses {
 public:
  /// Forgets the last image.
  void clear() { std::fill(std::begin(made_), std::end(made_), false); }

  /// Makes the responses of half side `half` (1 to kMaxInterpolatedHalf); does nothing if they are there.
  void make(const IntegralImage& image, int half);

  /// dx in the lower 16 bits, dy in the upper ones, both signed and in units of scale(), if they were made.
  /// Corner (x, y) stands at y * stride + x; only corners at least `half` inside the image have a value.
  const std::uint32_t* packed(int half) const { return maps_[half].data(); }
  float scale() const { return scale_; }  ///< gray levels times pixels, in counts of the integral image

 private:
  std::vector<std::uint32_t> maps_[kMaxInterpolatedHalf + 1];
  bool made_[kMaxInterpolatedHalf + 1] = {};
  float scale_ = 1.0f;
};

/// Responses of Haar wavelets at the samples of one keypoint. Keeps its buffers; one a thread.
class HaarSampler {
 public:
  /// Places the samples: (x, y) + [c -s; s c] offset, pixels of the integral image.
  void place(float x, float y, float c, float s, const SampleOffsets& offsets);

  /// Wavelets of side 2 `half` at the places, 0 for one that does not lie inside the image. `dense` has the responses
  /// of `half`, if it is at most kMaxInterpolatedHalf.
  void evaluate(const IntegralImage& image, const HaarResponses& dense, int half);

  const std::vector<float>& dx() const { return dx_; }  ///< right minus left half, gray levels times pixels
  const std::vector<float>& dy() const { return dy_; }  ///< lower minus upper half

 private:
  std::vector<float> x_, y_, dx_, dy_;
};

}  // namespace recognition
