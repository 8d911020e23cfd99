#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace recognition {

/// Integral image (Sec. 3.1 of Bay et al.), of the image itself or of the image at twice its size (bilinear).
///
/// Sums are exact: counts of 1 / `counts` gray level, modulo 2^32. A difference of corners is the sum over the box as
/// long as that fits in 31 bits, whatever wrapped before.
class IntegralImage {
 public:
  IntegralImage(const cv::Mat& gray, bool doubled);

  int width() const { return width_; }
  int height() const { return height_; }
  int stride() const { return stride_; }
  float counts() const { return doubled_ ? 16.0f : 1.0f; }

  /// Sum of all rows above y, columns left of x: 0 <= x <= width, 0 <= y <= height.
  const std::uint32_t* row(int y) const { return sums_.data() + static_cast<size_t>(y) * stride_; }

  /// Pixels of this image to pixels of the original, integers at centres.
  float toOriginal(float x) const { return doubled_ ? 0.5f * x - 0.25f : x; }
  float lengthToOriginal(float length) const { return doubled_ ? 0.5f * length : length; }

 private:
  bool doubled_;
  int width_;
  int height_;
  int stride_;
  std::vector<std::uint32_t> sums_;
};

}  // namespace recognition
