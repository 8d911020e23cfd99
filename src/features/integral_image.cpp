#include "features/integral_image.h"

#include <algorithm>
#include <opencv2/core/utility.hpp>

#include "core/simd.h"

namespace recognition {

// Vertical half of the bilinear doubling: 3/4 of the nearer row, 1/4 of the farther, in quarters.
RGBD_SIMD_CLONES void blendRows(const std::uint8_t* nearer, const std::uint8_t* farther, int n,
                                std::uint16_t* blended) {
  for (int x = 0; x < n; ++x) blended[x] = static_cast<std::uint16_t>(3 * nearer[x] + farther[x]);
}

// Horizontal half: `in` has one pixel of margin left and right.
RGBD_SIMD_CLONES void doubleColumns(const std::uint16_t* in, int n, std::uint16_t* out) {
  for (int x = 0; x < n; ++x) {
    out[2 * x] = static_cast<std::uint16_t>(in[x] + 3 * in[x + 1]);
    out[2 * x + 1] = static_cast<std::uint16_t>(3 * in[x + 1] + in[x + 2]);
  }
}

RGBD_SIMD_CLONES void addRow(const std::uint32_t* above, int n, std::uint32_t* row) {
  for (int x = 0; x < n; ++x) row[x] += above[x];
}

namespace {

constexpr int kColumnsPerStrip = 256;

template <typename T>
void prefixSums(const T* in, int n, std::uint32_t* out) {
  std::uint32_t sum = 0;
  out[0] = 0;
  for (int x = 0; x < n; ++x) out[x + 1] = sum += in[x];
}

void doubledRow(const cv::Mat& gray, int y, std::vector<std::uint16_t>& blended, std::vector<std::uint16_t>& row) {
  const int n = gray.cols, nearer = y / 2;
  const int farther = std::clamp(nearer + (y % 2 == 0 ? -1 : 1), 0, gray.rows - 1);
  blendRows(gray.ptr<std::uint8_t>(nearer), gray.ptr<std::uint8_t>(farther), n, blended.data() + 1);
  blended[0] = blended[1];
  blended[n + 1] = blended[n];
  doubleColumns(blended.data(), n, row.data());
}

}  // namespace

IntegralImage::IntegralImage(const cv::Mat& gray, bool doubled)
    : doubled_(doubled),
      width_(doubled ? 2 * gray.cols : gray.cols),
      height_(doubled ? 2 * gray.rows : gray.rows),
      stride_(width_ + 1),
      sums_(static_cast<size_t>(stride_) * (height_ + 1)) {
  cv::parallel_for_(cv::Range(0, height_), [&](const cv::Range& range) {
    std::vector<std::uint16_t> blended(gray.cols + 2), row(width_);
    for (int y = range.start; y < range.end; ++y) {
      std::uint32_t* out = sums_.data() + static_cast<size_t>(y + 1) * stride_;
      if (doubled_) {
        doubledRow(gray, y, blended, row);
        prefixSums(row.data(), width_, out);
      } else {
        prefixSums(gray.ptr<std::uint8_t>(y), width_, out);
      }
    }
  });
  const int strips = (stride_ + kColumnsPerStrip - 1) / kColumnsPerStrip;
  cv::parallel_for_(cv::Range(0, strips), [&](const cv::Range& range) {
    const int begin = range.start * kColumnsPerStrip, end = std::min(stride_, range.end * kColumnsPerStrip);
    for (int y = 1; y < height_; ++y)
      addRow(row(y) + begin, end - begin, sums_.data() + static_cast<size_t>(y + 1) * stride_ + begin);
  });
}

}  // namespace recognition
