#pragma once

#include <cstdint>
#include <algorithm>
#include <utility>
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
  NearestRows(int k, std::int32_t floor) : k_(static_cast<size_t>(k)), floor_(floor) {
    rows_.reserve(k_ <= kMaxInserted ? k_ : 2 * k_ + kSpare);
  }

  void offer(std::int32_t score, std::uint32_t row) {
    if (score <= floor_) return;
    if (k_ <= kMaxInserted) return insert(rankedRow(score, row));
    rows_.push_back(rankedRow(score, row));
    if (rows_.size() >= 2 * k_ + kSpare) keepBest();
  }
  /// The same for the rows of `blocks` blocks that have a score above the floor; `rows`: the row at each place in them.
  void offer(const BlockScores& found, const std::uint32_t* rows, int blocks);
  /// To be called after the last offer: leaves the k rows, sorted.
  void finish();
  /// Rows of this score or less have no chance.
  std::int32_t floor() const { return floor_; }
  /// After finish().
  const std::vector<RankedRow>& rows() const { return rows_; }

 private:
  static constexpr size_t kSpare = 8;         ///< rows beyond twice k that are kept for a while: sorting out costs time
  static constexpr size_t kMaxInserted = 16;  ///< so few rows are kept sorted, by insertion
  void keepBest();
  void insert(RankedRow ranked) {
    if (rows_.size() < k_)
      rows_.push_back(ranked);
    else if (ranked >= rows_.back())
      return;
    RankedRow* rows = rows_.data();
    size_t place = rows_.size() - 1;
    for (; place > 0 && ranked < rows[place - 1]; --place) rows[place] = rows[place - 1];
    rows[place] = ranked;
    if (rows_.size() == k_) floor_ = std::max(floor_, scoreOf(rows_.back()) - 1);
  }

  size_t k_;
  std::int32_t floor_;
  std::vector<RankedRow> rows_;
};

}  // namespace recognition
