#include "rgbd_recognition/matching/quantized_descriptors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "dot_kernels.h"

namespace rgbd_recognition {

QuantizedRows quantize(const cv::Mat& descriptors) {
  if (!descriptors.empty() && (descriptors.type() != CV_32FC1 || descriptors.cols % 4 != 0))
    throw std::invalid_argument("descriptors of OpenCV type " + std::to_string(descriptors.type()) + " with " +
                                std::to_string(descriptors.cols) + " columns cannot be quantised");
  QuantizedRows rows;
  rows.length = descriptors.cols;
  rows.values.resize(static_cast<size_t>(descriptors.rows) * rows.length);
  rows.norms.resize(descriptors.rows);
  rows.offsets.resize(descriptors.rows);
  for (int i = 0; i < descriptors.rows; ++i) {
    const float* from = descriptors.ptr<float>(i);
    std::int8_t* to = rows.values.data() + static_cast<size_t>(i) * rows.length;
    std::int32_t norm = 0, sum = 0;
    for (int k = 0; k < rows.length; ++k) {
      const float limited = std::min(std::max(from[k] * kDescriptorScale, -127.0f), 127.0f);
      const int value = static_cast<int>(limited + (limited < 0.0f ? -0.5f : 0.5f));
      to[k] = static_cast<std::int8_t>(value);
      norm += value * value;
      sum += value;
    }
    rows.norms[i] = norm;
    rows.offsets[i] = 128 * sum;
  }
  return rows;
}

void DescriptorBlocks::resize(int blocks) {
  DescriptorLane zero;
  std::fill(std::begin(zero.values), std::end(zero.values), std::uint8_t{128});
  lanes_.resize(static_cast<size_t>(blocks) * (length_ / 4), zero);
  half_norms_.resize(static_cast<size_t>(blocks) * kBlockRows, -kEmptyScore);
}

void DescriptorBlocks::set(int slot, const QuantizedRows& rows, int row) {
  if (rows.length != length_)
    throw std::invalid_argument("descriptors of " + std::to_string(rows.length) + " elements among those of " +
                                std::to_string(length_));
  DescriptorLane* lanes = lanes_.data() + static_cast<size_t>(slot / kBlockRows) * (length_ / 4);
  const std::int8_t* from = rows.row(row);
  for (int lane = 0; lane < length_ / 4; ++lane)
    for (int k = 0; k < 4; ++k)
      lanes[lane].values[4 * (slot % kBlockRows) + k] = static_cast<std::uint8_t>(from[4 * lane + k] + 128);
  half_norms_[slot] = rows.norms[row] / 2;
}

bool kernelSupported(DotKernel kernel) {
#if defined(__x86_64__) && defined(__GNUC__)
  if (kernel == DotKernel::kAvx2) return __builtin_cpu_supports("avx2");
  if (kernel == DotKernel::kAvx512Vnni)
    return __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vnni");
#endif
  return kernel == DotKernel::kPortable;
}

DotKernel fastestKernel() {
  static const DotKernel fastest = kernelSupported(DotKernel::kAvx512Vnni) ? DotKernel::kAvx512Vnni
                                   : kernelSupported(DotKernel::kAvx2)     ? DotKernel::kAvx2
                                                                           : DotKernel::kPortable;
  return fastest;
}

void scoreBlocks(const DescriptorBlocks& blocks, int first_block, int block_count, const QuantizedRows& queries,
                 int query, std::int32_t* scores, DotKernel kernel) {
  const DotTask task{blocks.lanes(first_block), blocks.halfNorms(first_block), block_count, blocks.length() / 4,
                     queries.row(query),        queries.offsets[query],        scores};
  switch (kernel) {
    case DotKernel::kPortable: return scorePortable(task);
    case DotKernel::kAvx2: return scoreAvx2(task);
    case DotKernel::kAvx512Vnni: return scoreAvx512Vnni(task);
  }
}

float distanceFromScore(std::int32_t query_norm, std::int32_t score) {
  return std::sqrt(static_cast<float>(std::max(query_norm - 2 * score, 0))) / kDescriptorScale;
}

std::int32_t scoreFloor(std::int32_t query_norm, double distance) {
  const double scaled = distance * kDescriptorScale;
  return static_cast<std::int32_t>(std::floor((query_norm - scaled * scaled) / 2.0));
}

}  // namespace rgbd_recognition
