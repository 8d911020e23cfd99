#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/features/feature_types.h"

namespace recognition {

/// Descriptors to search with, row by row, as quantizedDescriptors() makes them.
struct QuantizedRows {
  int length = 0;                     ///< elements a row, a multiple of 4
  std::vector<std::int8_t> values;    ///< count x length
  std::vector<std::int32_t> norms;    ///< squared, in quantised units
  std::vector<std::int32_t> offsets;  ///< 128 * sum of the row's elements

  int count() const { return static_cast<int>(norms.size()); }
  const std::int8_t* row(int i) const { return values.data() + static_cast<size_t>(i) * length; }
};

/// `descriptors` n x length, CV_32FC1 or CV_8SC1; throws std::invalid_argument for another type or a length that is no
/// multiple of 4.
QuantizedRows quantize(const cv::Mat& descriptors);

/// Four elements of each of 16 rows, as unsigned (value + 128): what one dot-product instruction takes.
struct alignas(64) DescriptorLane {
  std::uint8_t values[64];
};
constexpr int kBlockRows = 16;

/// Descriptors to search in: blocks of 16 rows, each of length / 4 lanes.
class DescriptorBlocks {
 public:
  explicit DescriptorBlocks(int length = 4) : length_(length) {}

  /// Room for `blocks` blocks of empty rows, to be filled with set().
  void resize(int blocks);
  /// Puts rows.row(row) at a slot (block * 16 + place in it). Different slots may be set from different threads.
  void set(int slot, const QuantizedRows& rows, int row);

  int length() const { return length_; }
  int blockCount() const { return static_cast<int>(half_norms_.size()) / kBlockRows; }
  size_t bytes() const { return lanes_.size() * sizeof(DescriptorLane) + half_norms_.size() * sizeof(std::int32_t); }
  const DescriptorLane* lanes(int block) const { return lanes_.data() + static_cast<size_t>(block) * (length_ / 4); }
  const std::int32_t* halfNorms(int block) const {
    return half_norms_.data() + static_cast<size_t>(block) * kBlockRows;
  }

 private:
  int length_;
  std::vector<DescriptorLane> lanes_;
  std::vector<std::int32_t> half_norms_;
};

/// Score of an empty row: below all others.
constexpr std::int32_t kEmptyScore = -(1 << 29);

/// Instruction sets that the scores can be computed with; all give the same numbers.
enum class DotKernel { kPortable, kAvx2, kAvx512Vnni };
bool kernelSupported(DotKernel kernel);
DotKernel fastestKernel();

/// Scores of up to kMaxBlocks blocks, and where they are above a floor.
constexpr int kMaxBlocks = 32;  // they stay in the first-level cache
struct BlockScores {
  std::int32_t scores[kMaxBlocks * kBlockRows];
  std::uint16_t above[kMaxBlocks];  ///< of each block: a bit for each row
};

/// Scores of `block_count` blocks from `first_block` on, 16 each: <row, query> - |row|^2 / 2, so that squared distance
/// = |query|^2 - 2 score in quantised units (|row|^2 / 2 is rounded down: an error of at most 1 / kDescriptorScale^2 in
/// squared distance).
void scoreBlocks(const DescriptorBlocks& blocks, int first_block, int block_count, const QuantizedRows& queries,
                 int query, std::int32_t floor, BlockScores* result, DotKernel kernel = fastestKernel());

/// Distance of unit-length descriptors from a score.
float distanceFromScore(std::int32_t query_norm, std::int32_t score);
/// Largest score that is not nearer than `distance`.
std::int32_t scoreFloor(std::int32_t query_norm, double distance);

}  // namespace recognition
