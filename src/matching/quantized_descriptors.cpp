#include "matching/quantized_descriptors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "matching/dot_kernels.h"
#include "core/simd.h"

namespace recognition {
namespace {

RGBD_SIMD_CLONES void addUp(const std::int8_t* values, int length, std::int32_t& squares, std::int32_t& sum) {
  for (int k = 0; k < length; ++k) {
    squares += values[k] * values[k];
    sum += values[k];
  }
}

}  // namespace

QuantizedRows quantize(const cv::Mat& descriptors) {
  if (descriptors.cols % 4 != 0)
    throw std::invalid_argument("descriptors with " + std::to_string(descriptors.cols) +
                                " elements, which is no multiple of 4");
  const cv::Mat quantized = quantizedDescriptors(descriptors);
  QuantizedRows rows;
  rows.length = descriptors.cols;
  rows.values.reserve(descriptors.total());
  for (int i = 0; i < quantized.rows; ++i) {
    const auto* values = quantized.ptr<std::int8_t>(i);
    rows.values.insert(rows.values.end(), values, values + rows.length);
    std::int32_t norm = 0, sum = 0;
    addUp(values, rows.length, norm, sum);
    rows.norms.push_back(norm);
    rows.offsets.push_back(128 * sum);
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
                 int query, std::int32_t floor, BlockScores* result, DotKernel kernel) {
  const DotTask task{blocks.lanes(first_block),
                     blocks.halfNorms(first_block),
                     block_count,
                     blocks.length() / 4,
                     queries.row(query),
                     queries.offsets[query],
                     floor,
                     result->scores,
                     result->above};
  switch (kernel) {
    case DotKernel::kPortable:
      return scorePortable(task);
    case DotKernel::kAvx2:
      return scoreAvx2(task);
    case DotKernel::kAvx512Vnni:
      return scoreAvx512Vnni(task);
  }
}

float distanceFromScore(std::int32_t query_norm, std::int32_t score) {
  return std::sqrt(static_cast<float>(std::max(query_norm - 2 * score, 0))) / kDescriptorScale;
}

std::int32_t scoreFloor(std::int32_t query_norm, double distance) {
  const double scaled = distance * kDescriptorScale;
  return static_cast<std::int32_t>(std::floor((query_norm - scaled * scaled) / 2.0));
}

}  // namespace recognition
