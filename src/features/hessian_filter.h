#pragma once

#include <cstdint>
#include <vector>

#include "features/integral_image.h"

namespace recognition {

/// The box filters that stand for the second derivatives of a Gaussian (Sec. 3.2 and Fig. 2 of Bay et al.), of one
/// size.
///
/// A row of responses costs few loads: the boxes' vertical differences are taken once for all columns, then combined
/// along the row.
class HessianFilter {
 public:
  /// `size`: 9, 15, 21, ...: three lobes.
  explicit HessianFilter(int size) : size_(size), lobe_(size / 3), half_((size - 1) / 2) {}

  int size() const { return size_; }
  int margin() const { return half_; }  ///< pixels that must lie around a pixel

  /// Buffers of a thread.
  struct Rows {
    std::vector<std::uint32_t> xx, yy, xy;
  };

  /// determinants[i] = Dxx Dyy - (0.9 Dxy)^2 (eq. 3) at pixel (x + i step, y), i < n. All of them at least margin()
  /// inside.
  void determinants(const IntegralImage& image, int x, int y, int step, int n, Rows& rows, float* determinants) const;

  /// Dxx + Dyy > 0 at a pixel: the sign of the Laplacian, dark blob on bright.
  bool isDark(const IntegralImage& image, int x, int y) const;

 private:
  int size_;
  int lobe_;
  int half_;
};

}  // namespace recognition
