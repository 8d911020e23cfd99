#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "matching/quantized_descriptors.h"

namespace recognition {

/// A row with its score as one number, which sorts fast: nearer ones are less, of equal ones the lower row.
using RankedRow = std::uint64_t;
inline RankedRow rankedRow(std::int32_t score, std::uint32_t row) {
  return static_cast<RankedRow>(static_cast<std::int64_t>(INT32_MAX) - score) << 32 | row;
}
inline std::uint32_t rowOf(RankedRow ranked) { return static_cast<std::uint32_t>(ranked); }
inline std::int32_t scoreOf(RankedRow ranked) {
  return static_cast<std::int32_t>(INT32_MAX - static_cast<std::int64_t>(ranked >> 32));
}

/// The k best rows above a floor, by falling score, then by row: whatever the order in which they are offered.
class NearestRows {
 public:
  NearestRows(int k, std::int32_t floor) : k_(static_cast<size_t>(k)), floor_(floor) {}

  void offer(std::int32_t score, std::uint32_t row) {
    if (score <= floor_) return;
    rows_.push_back(rankedRow(score, row));
    if (rows_.size() >= 2 * k_ + kSpare) keepBest();
  }
  /// The same for the rows of `blocks` blocks that have a score above the floor; `rows`: the row at each place in them.
  void offer(const BlockScores& found, const std::uint32_t* rows, int blocks);
  /// To be called after the last offer: leaves the k rows, the best `sorted` of them first and sorted.
  void finish(size_t sorted = std::numeric_limits<size_t>::max());
  /// Rows of this score or less have no chance.
  std::int32_t floor() const { return floor_; }
  /// After finish().
  const std::vector<RankedRow>& rows() const { return rows_; }

 private:
  static constexpr size_t kSpare = 8;  ///< rows beyond twice k that are kept for a while: sorting out costs time
  void keepBest();

  size_t k_;
  std::int32_t floor_;
  std::vector<RankedRow> rows_;
};

}  // namespace recognition
