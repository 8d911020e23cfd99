#include "features/haar_wavelets.h"

#include <algorithm>

#include <opencv2/core/utility.hpp>

#include "core/simd.h"

namespace recognition {

RGBD_SIMD_CLONES void placeSamples(float x, float y, float c, float s, const float* offset_x, const float* offset_y,
                                   int n, float* out_x, float* out_y) {
  for (int i = 0; i < n; ++i) {
    out_x[i] = x + c * offset_x[i] - s * offset_y[i];
    out_y[i] = y + s * offset_x[i] + c * offset_y[i];
  }
}

// Responses at one row of corners, from column `half` to `last`. `shift` makes them fit into 16 bits.
RGBD_SIMD_CLONES void haarRow(const std::uint32_t* up, const std::uint32_t* middle, const std::uint32_t* down, int half,
                              int last, int shift, std::uint32_t* packed) {
  const std::int32_t rounding = (1 << shift) >> 1;
  for (int x = half; x <= last; ++x) {
    const std::uint32_t left = down[x - half] - up[x - half], right = down[x + half] - up[x + half];
    const std::uint32_t upper_left = middle[x - half] - up[x - half], upper_right = middle[x + half] - up[x + half];
    const auto dx = static_cast<std::int32_t>(right - 2u * (down[x] - up[x]) + left);
    const auto dy = static_cast<std::int32_t>(right - left - 2u * (upper_right - upper_left));
    packed[x] = (static_cast<std::uint32_t>((dx + rounding) >> shift) & 0xffffu) |
                static_cast<std::uint32_t>((dy + rounding) >> shift) << 16;
  }
}

// Bilinear in packed responses; 0 outside of the corners that have one.
RGBD_SIMD_CLONES void interpolate(const std::uint32_t* packed, int stride, float first, float last_x, float last_y,
                                  float scale, const float* x, const float* y, int n, float* dx, float* dy) {
  for (int i = 0; i < n; ++i) {
    const bool inside = (x[i] >= first) & (y[i] >= first) & (x[i] < last_x) & (y[i] < last_y);
    const float u = inside ? x[i] : first, v = inside ? y[i] : first;
    const int iu = static_cast<int>(u), iv = static_cast<int>(v), at = iv * stride + iu;
    const float fu = u - static_cast<float>(iu), fv = v - static_cast<float>(iv);
    const auto blend = [=](float a, float b, float c, float d) {
      const float top = a + fu * (b - a), bottom = c + fu * (d - c);
      return top + fv * (bottom - top);
    };
    const auto low = [](std::uint32_t p) { return static_cast<float>(static_cast<std::int32_t>(p << 16) >> 16); };
    const auto high = [](std::uint32_t p) { return static_cast<float>(static_cast<std::int32_t>(p) >> 16); };
    const std::uint32_t a = packed[at], b = packed[at + 1], c = packed[at + stride], d = packed[at + stride + 1];
    const float weight = inside ? scale : 0.0f;
    dx[i] = weight * blend(low(a), low(b), low(c), low(d));
    dy[i] = weight * blend(high(a), high(b), high(c), high(d));
  }
}

// Wavelets at the nearest places; 0 where one does not fit in. `sums` of `width` x `height` pixels.
RGBD_SIMD_CLONES void nearestWavelets(const std::uint32_t* sums, int stride, int width, int height, int half,
                                      const float* x, const float* y, int n, float* dx, float* dy) {
  const float left = static_cast<float>(half), right = static_cast<float>(width - half);
  const float bottom = static_cast<float>(height - half);
  const int up = -half * stride, down = half * stride;
  for (int i = 0; i < n; ++i) {
    const float u = x[i] + 0.5f, v = y[i] + 0.5f;
    const bool inside = (u >= left) & (v >= left) & (u < right + 1.0f) & (v < bottom + 1.0f);
    const int column = static_cast<int>(inside ? u : left), row = static_cast<int>(inside ? v : left);
    const int at = row * stride + column;  // indices, not pointers, so that the compiler gathers
    const std::uint32_t up_left = sums[at + up - half], up_right = sums[at + up + half];
    const std::uint32_t down_left = sums[at + down - half], down_right = sums[at + down + half];
    const std::uint32_t corners = down_right - down_left - up_right + up_left;  // the whole wavelet
    const std::uint32_t left_part = sums[at + down] - down_left - sums[at + up] + up_left;
    const std::uint32_t upper_part = sums[at + half] - sums[at - half] - up_right + up_left;
    const float weight = inside ? 1.0f : 0.0f;
    dx[i] = weight * static_cast<float>(static_cast<std::int32_t>(corners - 2u * left_part));
    dy[i] = weight * static_cast<float>(static_cast<std::int32_t>(corners - 2u * upper_part));
  }
}

void HaarResponses::make(const IntegralImage& image, int half) {
  if (made_[half] || 2 * half > image.width() || 2 * half > image.height()) return;
  // 2 half^2 pixels of 255 gray levels at most: 15 bits for half 4, and 4 more where a gray level has 16 counts.
  const int shift = image.counts() > 1.0f ? 2 : 0;
  scale_ = static_cast<float>(1 << shift);
  const size_t count = static_cast<size_t>(image.height() + 1) * image.stride();
  if (maps_[half].size() < count) maps_[half].resize(count);
  made_[half] = true;
  cv::parallel_for_(cv::Range(half, image.height() - half + 1), [&](const cv::Range& range) {
    for (int y = range.start; y < range.end; ++y)
      haarRow(image.row(y - half), image.row(y), image.row(y + half), half, image.width() - half, shift,
              maps_[half].data() + static_cast<size_t>(y) * image.stride());
  });
}

void HaarSampler::place(float x, float y, float c, float s, const SampleOffsets& offsets) {
  const size_t n = offsets.x.size();
  for (auto* values : {&x_, &y_, &dx_, &dy_}) values->resize(n);
  // Place p of a pixel's centre is corner p + 1/2 of the integral image.
  placeSamples(x + 0.5f, y + 0.5f, c, s, offsets.x.data(), offsets.y.data(), static_cast<int>(n), x_.data(), y_.data());
}

void HaarSampler::evaluate(const IntegralImage& image, const HaarResponses& dense, int half) {
  const int n = static_cast<int>(x_.size());
  if (2 * half > image.width() || 2 * half > image.height()) {
    std::fill(dx_.begin(), dx_.end(), 0.0f);
    std::fill(dy_.begin(), dy_.end(), 0.0f);
  } else if (half <= kMaxInterpolatedHalf) {
    interpolate(dense.packed(half), image.stride(), static_cast<float>(half), static_cast<float>(image.width() - half),
                static_cast<float>(image.height() - half), dense.scale(), x_.data(), y_.data(), n, dx_.data(),
                dy_.data());
  } else {
    nearestWavelets(image.row(0), image.stride(), image.width(), image.height(), half, x_.data(), y_.data(), n,
                    dx_.data(), dy_.data());
  }
}

}  // namespace recognition
