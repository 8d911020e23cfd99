#include "haar_wavelets.h"

#include <cmath>

#include "rgbd_recognition/core/simd.h"

namespace rgbd_recognition {

// A place p lies between the corners floor(p + 1/2) and the next; the wavelet needs `half` corners on each side of
// both.
RGBD_SIMD_CLONES void haarCorners(const float* x, const float* y, int n, int width, int height, int stride, int half,
                                  std::int32_t* base, float* fx, float* fy, float* inside) {
  const float low = static_cast<float>(half), right = static_cast<float>(width - half - 1),
              bottom = static_cast<float>(height - half - 1);
  for (int i = 0; i < n; ++i) {
    const float u = x[i] + 0.5f, v = y[i] + 0.5f;
    const bool good = (u >= low) & (v >= low) & (u < right) & (v < bottom);
    const float cu = good ? u : low, cv = good ? v : low;
    const int iu = static_cast<int>(cu), iv = static_cast<int>(cv);
    base[i] = iv * stride + iu;
    fx[i] = cu - static_cast<float>(iu);
    fy[i] = cv - static_cast<float>(iv);
    inside[i] = good ? 1.0f : 0.0f;
  }
}

RGBD_SIMD_CLONES void haarResponses(const std::uint32_t* sums, int stride, int half, int n, const std::int32_t* base,
                                    const float* fx, const float* fy, const float* inside, float* dx, float* dy) {
  const int up = -half * stride, down = half * stride;
  for (int i = 0; i < n; ++i) {
    const std::uint32_t* p = sums + base[i];
    // Sums over the columns left of c, between the wavelet's top and bottom, and over the rows above r, between left
    // and right.
    const auto column = [&](int c) { return p[down + c] - p[up + c]; };
    const auto lowerColumn = [&](int c) { return p[down + stride + c] - p[up + stride + c]; };
    const auto rowSum = [&](int r) { return p[r + half] - p[r - half]; };
    const auto righterRow = [&](int r) { return p[r + half + 1] - p[r - half + 1]; };
    const auto bend = [](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      return static_cast<float>(static_cast<std::int32_t>(a - 2u * b + c));
    };
    const float x00 = bend(column(-half), column(0), column(half)),
                x10 = bend(column(1 - half), column(1), column(1 + half));
    const float x01 = bend(lowerColumn(-half), lowerColumn(0), lowerColumn(half));
    const float x11 = bend(lowerColumn(1 - half), lowerColumn(1), lowerColumn(1 + half));
    const float y00 = bend(rowSum(up), rowSum(0), rowSum(down)),
                y10 = bend(righterRow(up), righterRow(0), righterRow(down));
    const float y01 = bend(rowSum(up + stride), rowSum(stride), rowSum(down + stride));
    const float y11 = bend(righterRow(up + stride), righterRow(stride), righterRow(down + stride));
    const float ax = x00 + fx[i] * (x10 - x00), bx = x01 + fx[i] * (x11 - x01);
    const float ay = y00 + fx[i] * (y10 - y00), by = y01 + fx[i] * (y11 - y01);
    dx[i] = inside[i] * (ax + fy[i] * (bx - ax));
    dy[i] = inside[i] * (ay + fy[i] * (by - ay));
  }
}

void HaarSamples::resize(size_t n) {
  for (auto* values : {&x, &y, &dx, &dy, &fx, &fy, &inside}) values->resize(n);
  base.resize(n);
}

void HaarSamples::evaluate(const IntegralImage& image, int half) {
  const int n = static_cast<int>(x.size());
  if (image.width() <= 2 * half + 1 || image.height() <= 2 * half + 1) {
    std::fill(dx.begin(), dx.end(), 0.0f);
    std::fill(dy.begin(), dy.end(), 0.0f);
    return;
  }
  haarCorners(x.data(), y.data(), n, image.width(), image.height(), image.stride(), half, base.data(), fx.data(),
              fy.data(), inside.data());
  haarResponses(image.row(0), image.stride(), half, n, base.data(), fx.data(), fy.data(), inside.data(), dx.data(),
                dy.data());
}

}  // namespace rgbd_recognition
