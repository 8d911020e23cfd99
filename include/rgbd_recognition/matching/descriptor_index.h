#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_recognition/matching/quantized_descriptors.h"

namespace rgbd_recognition {

/// A row of the index with its score (see scoreBlocks); larger is nearer.
struct ScoredRow {
  std::int32_t score = 0;
  std::uint32_t row = 0;
};

/// The k best rows above a floor, by falling score; of equal scores the first offered stays first.
class NearestRows {
 public:
  NearestRows(int k, std::int32_t floor) : k_(static_cast<size_t>(k)), floor_(floor) {}

  void offer(std::int32_t score, std::uint32_t row) {
    if (score > floor_) insert({score, row});
  }
  std::int32_t floor() const { return floor_; }
  const std::vector<ScoredRow>& rows() const { return rows_; }

 private:
  void insert(const ScoredRow& candidate);

  size_t k_;
  std::int32_t floor_;
  std::vector<ScoredRow> rows_;
};

/// All models' descriptors in one place, searched by nearest neighbour in Euclidean distance of the quantised descriptors.
class DescriptorIndex {
 public:
  /// Row numbers of the index count through `models` in order. Every matrix as in quantize(), all of `length` columns.
  DescriptorIndex(const std::vector<cv::Mat>& models, int length);

  /// The `k` nearest rows to queries.row(query) nearer than `max_distance`.
  NearestRows nearest(const QuantizedRows& queries, int query, int k, double max_distance) const;

  int count() const { return count_; }
  size_t bytes() const;

 private:
  void scan(int first_block, int end_block, const QuantizedRows& queries, int query, NearestRows& nearest) const;

  int count_ = 0;
  DescriptorBlocks blocks_;
  std::vector<std::uint32_t> rows_;  ///< row number of each slot of blocks_
};

}  // namespace rgbd_recognition
