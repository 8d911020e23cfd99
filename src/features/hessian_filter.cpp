#include "features/hessian_filter.h"

#include "core/simd.h"

namespace recognition {

struct HessianRowPointers {
  const std::uint32_t* xx[2];  // bottom, top of the lobes of Dxx
  const std::uint32_t* yy[4];  // bottom, top of all lobes of Dyy, bottom, top of the middle one
  const std::uint32_t* xy[4];  // bottom, top of the upper lobes of Dxy, bottom, top of the lower ones
};

RGBD_SIMD_CLONES void hessianVertical(const HessianRowPointers& p, int n, std::uint32_t* xx, std::uint32_t* yy,
                                      std::uint32_t* xy) {
  for (int i = 0; i < n; ++i) xx[i] = p.xx[0][i] - p.xx[1][i];
  for (int i = 0; i < n; ++i) yy[i] = p.yy[0][i] - p.yy[1][i] - 3u * (p.yy[2][i] - p.yy[3][i]);
  for (int i = 0; i < n; ++i) xy[i] = p.xy[0][i] - p.xy[1][i] - p.xy[2][i] + p.xy[3][i];
}

// Pointers to the column of the first sample; `step` columns from sample to sample.
static inline float hessianAt(const std::uint32_t* xx, const std::uint32_t* yy, const std::uint32_t* xy, int i,
                              int lobe, float scale) {
  const int half = (3 * lobe - 1) / 2, middle = (lobe - 1) / 2;
  const std::uint32_t dxx = xx[i + half + 1] - xx[i - half] - 3u * (xx[i + middle + 1] - xx[i - middle]);
  const std::uint32_t dyy = yy[i + lobe] - yy[i - lobe + 1];
  const std::uint32_t dxy = xy[i] - xy[i - lobe] - xy[i + lobe + 1] + xy[i + 1];
  const float x = scale * static_cast<float>(static_cast<std::int32_t>(dxx));
  const float y = scale * static_cast<float>(static_cast<std::int32_t>(dyy));
  const float c = 0.9f * scale * static_cast<float>(static_cast<std::int32_t>(dxy));
  return x * y - c * c;
}

RGBD_SIMD_CLONES void hessianHorizontal(const std::uint32_t* xx, const std::uint32_t* yy, const std::uint32_t* xy,
                                        int step, int lobe, float scale, int n, float* out) {
  if (step == 1)
    for (int i = 0; i < n; ++i) out[i] = hessianAt(xx, yy, xy, i, lobe, scale);
  else if (step == 2)
    for (int i = 0; i < n; ++i) out[i] = hessianAt(xx, yy, xy, 2 * i, lobe, scale);
  else
    for (int i = 0; i < n; ++i) out[i] = hessianAt(xx, yy, xy, step * i, lobe, scale);
}

void HessianFilter::determinants(const IntegralImage& image, int x, int y, int step, int n, Rows& rows,
                                 float* determinants) const {
  const int middle = (lobe_ - 1) / 2, first = x - half_, columns = (n - 1) * step + size_ + 1;
  const auto at = [&](int dy) { return image.row(y + dy) + first; };
  const HessianRowPointers pointers{{at(lobe_), at(1 - lobe_)},
                                    {at(half_ + 1), at(-half_), at(middle + 1), at(-middle)},
                                    {at(0), at(-lobe_), at(lobe_ + 1), at(1)}};
  rows.xx.resize(columns);
  rows.yy.resize(columns);
  rows.xy.resize(columns);
  hessianVertical(pointers, columns, rows.xx.data(), rows.yy.data(), rows.xy.data());
  const float scale = 1.0f / (image.counts() * static_cast<float>(size_) * static_cast<float>(size_));
  hessianHorizontal(rows.xx.data() + half_, rows.yy.data() + half_, rows.xy.data() + half_, step, lobe_, scale, n,
                    determinants);
}

bool HessianFilter::isDark(const IntegralImage& image, int x, int y) const {
  const auto box = [&](int left, int top, int right, int bottom) {  // inclusive, relative to the pixel
    const std::uint32_t *above = image.row(y + top) + x, *below = image.row(y + bottom + 1) + x;
    return static_cast<std::int32_t>(below[right + 1] - below[left] - above[right + 1] + above[left]);
  };
  const int l = lobe_ - 1, middle = (lobe_ - 1) / 2;
  const std::int64_t xx = box(-half_, -l, half_, l) - std::int64_t{3} * box(-middle, -l, middle, l);
  const std::int64_t yy = box(-l, -half_, l, half_) - std::int64_t{3} * box(-l, -middle, l, middle);
  return xx + yy > 0;
}

}  // namespace recognition
