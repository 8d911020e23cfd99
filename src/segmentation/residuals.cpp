#include "segmentation/residuals.h"

#include <cstring>

#include "core/simd.h"

namespace recognition {
namespace {

RGBD_SIMD_CLONES std::int32_t residualLoop(const float* z, int n, float t0, float c0, float c1, float c2,
                                           std::int32_t* residuals) {
  std::int32_t largest = 0;
  for (int i = 0; i < n; ++i) {
    const float t = t0 + static_cast<float>(i);
    const float r = z[i] - (c0 + t * (c1 + t * c2));
    std::int32_t bits;
    std::memcpy(&bits, &r, sizeof(bits));
    bits &= 0x7fffffff;
    residuals[i] = bits;
    largest = bits > largest ? bits : largest;
  }
  return largest;
}

}  // namespace

std::int32_t residualBits(const float* z, int n, int first, const Polynomial& p, std::int32_t* residuals) {
  return residualLoop(z, n, static_cast<float>(first - p.centre), static_cast<float>(p.c0), static_cast<float>(p.c1),
                      static_cast<float>(p.c2), residuals);
}

std::int32_t bitsOf(float value) {
  std::int32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return bits;
}

}  // namespace recognition
