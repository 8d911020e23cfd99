#include "features/haar_wavelets.h"

#include <algorithm>
#include <cmath>

#include "core/simd.h"

namespace recognition {

constexpr int kInterpolatedHalf = 4;  // pixels; larger wavelets are taken at the nearest place

RGBD_SIMD_CLONES void placeSamples(float x, float y, float c, float s, const float* offset_x, const float* offset_y,
                                   int n, float* out_x, float* out_y) {
  for (int i = 0; i < n; ++i) {
    out_x[i] = x + c * offset_x[i] - s * offset_y[i];
    out_y[i] = y + s * offset_x[i] + c * offset_y[i];
  }
}

// One row of wavelets, the first centred at column `half` of the three rows of sums.
RGBD_SIMD_CLONES void haarRow(const std::uint32_t* up, const std::uint32_t* middle, const std::uint32_t* down, int half,
                              int n, std::uint32_t* band, float* dx, float* dy) {
  for (int i = 0; i < n + 2 * half; ++i) band[i] = down[i] - up[i];
  for (int i = 0; i < n; ++i)
    dx[i] = static_cast<float>(static_cast<std::int32_t>(band[i + 2 * half] - 2u * band[i + half] + band[i]));
  for (int i = 0; i < n + 2 * half; ++i) band[i] = down[i] - 2u * middle[i] + up[i];
  for (int i = 0; i < n; ++i) dy[i] = static_cast<float>(static_cast<std::int32_t>(band[i + 2 * half] - band[i]));
}

// Bilinear in dense responses of `columns` x `rows`; (x, y) relative to the first.
RGBD_SIMD_CLONES void interpolate(const float* dense_dx, const float* dense_dy, int columns, int rows, const float* x,
                                  const float* y, float first_x, float first_y, int n, float* dx, float* dy) {
  const float last_x = static_cast<float>(columns - 1), last_y = static_cast<float>(rows - 1);
  for (int i = 0; i < n; ++i) {
    const float u = x[i] - first_x, v = y[i] - first_y;
    const bool inside = (u >= 0.0f) & (v >= 0.0f) & (u < last_x) & (v < last_y);
    const float cu = inside ? u : 0.0f, cv = inside ? v : 0.0f;
    const int iu = static_cast<int>(cu), iv = static_cast<int>(cv), at = iv * columns + iu;
    const float fu = cu - static_cast<float>(iu), fv = cv - static_cast<float>(iv);
    const auto blend = [=](const float* p) {
      const float top = p[0] + fu * (p[1] - p[0]), bottom = p[columns] + fu * (p[columns + 1] - p[columns]);
      return top + fv * (bottom - top);
    };
    const float weight = inside ? 1.0f : 0.0f;
    dx[i] = weight * blend(dense_dx + at);
    dy[i] = weight * blend(dense_dy + at);
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

void HaarSampler::place(float x, float y, float c, float s, const SampleOffsets& offsets) {
  const size_t n = offsets.x.size();
  for (auto* values : {&x_, &y_, &dx_, &dy_}) values->resize(n);
  // Place p of a pixel's centre is corner p + 1/2 of the integral image.
  placeSamples(x + 0.5f, y + 0.5f, c, s, offsets.x.data(), offsets.y.data(), static_cast<int>(n), x_.data(), y_.data());
}

void HaarSampler::evaluate(const IntegralImage& image, int half) {
  if (half <= kInterpolatedHalf)
    evaluateInterpolated(image, half);
  else
    evaluateNearest(image, half);
}

void HaarSampler::evaluateNearest(const IntegralImage& image, int half) {
  if (2 * half > image.width() || 2 * half > image.height()) {
    std::fill(dx_.begin(), dx_.end(), 0.0f);
    std::fill(dy_.begin(), dy_.end(), 0.0f);
    return;
  }
  nearestWavelets(image.row(0), image.stride(), image.width(), image.height(), half,
                  x_.data(), y_.data(), static_cast<int>(x_.size()), dx_.data(), dy_.data());
}

void HaarSampler::evaluateInterpolated(const IntegralImage& image, int half) {
  const auto [min_x, max_x] = std::minmax_element(x_.begin(), x_.end());
  const auto [min_y, max_y] = std::minmax_element(y_.begin(), y_.end());
  const int left = std::max(half, static_cast<int>(std::floor(*min_x)));
  const int top = std::max(half, static_cast<int>(std::floor(*min_y)));
  const int columns = std::min(image.width() - half, static_cast<int>(std::floor(*max_x)) + 1) - left + 1;
  const int rows = std::min(image.height() - half, static_cast<int>(std::floor(*max_y)) + 1) - top + 1;
  if (columns < 2 || rows < 2) {
    std::fill(dx_.begin(), dx_.end(), 0.0f);
    std::fill(dy_.begin(), dy_.end(), 0.0f);
    return;
  }
  const size_t count = static_cast<size_t>(columns) * rows;
  if (dense_dx_.size() < count) {
    dense_dx_.resize(count);
    dense_dy_.resize(count);
  }
  band_.resize(columns + 2 * half);
  for (int row = 0; row < rows; ++row) {
    const auto at = [&](int dy) { return image.row(top + row + dy) + left - half; };
    haarRow(at(-half), at(0), at(half), half, columns, band_.data(), dense_dx_.data() + row * columns,
            dense_dy_.data() + row * columns);
  }
  interpolate(dense_dx_.data(), dense_dy_.data(), columns, rows, x_.data(), y_.data(), static_cast<float>(left),
              static_cast<float>(top), static_cast<int>(x_.size()), dx_.data(), dy_.data());
}

}  // namespace recognition
