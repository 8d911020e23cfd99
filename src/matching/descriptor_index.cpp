#include "rgbd_recognition/matching/descriptor_index.h"

#include <algorithm>

namespace rgbd_recognition {
namespace {

constexpr int kScanBlocks = 32;  // scores of a stretch stay in the first-level cache

}  // namespace

void NearestRows::insert(const ScoredRow& candidate) {
  const auto by_score = [](const ScoredRow& a, const ScoredRow& b) { return a.score > b.score; };
  rows_.insert(std::upper_bound(rows_.begin(), rows_.end(), candidate, by_score), candidate);
  if (rows_.size() > k_) rows_.pop_back();
  if (rows_.size() == k_) floor_ = std::max(floor_, rows_.back().score);
}

DescriptorIndex::DescriptorIndex(const std::vector<cv::Mat>& models, int length) : blocks_(length) {
  for (const cv::Mat& model : models) count_ += model.rows;
  blocks_.resize((count_ + kBlockRows - 1) / kBlockRows);
  rows_.resize(static_cast<size_t>(blocks_.blockCount()) * kBlockRows);
  int slot = 0;
  for (const cv::Mat& model : models) {
    const QuantizedRows rows = quantize(model);
    for (int i = 0; i < rows.count(); ++i, ++slot) {
      blocks_.set(slot, rows, i);
      rows_[slot] = static_cast<std::uint32_t>(slot);
    }
  }
}

NearestRows DescriptorIndex::nearest(const QuantizedRows& queries, int query, int k, double max_distance) const {
  NearestRows nearest(k, scoreFloor(queries.norms[query], max_distance));
  scan(0, blocks_.blockCount(), queries, query, nearest);
  return nearest;
}

void DescriptorIndex::scan(int first_block, int end_block, const QuantizedRows& queries, int query,
                           NearestRows& nearest) const {
  std::int32_t scores[kScanBlocks * kBlockRows];
  for (int block = first_block; block < end_block; block += kScanBlocks) {
    const int blocks = std::min(kScanBlocks, end_block - block);
    scoreBlocks(blocks_, block, blocks, queries, query, scores);
    const std::uint32_t* rows = rows_.data() + static_cast<size_t>(block) * kBlockRows;
    for (int b = 0; b < blocks; ++b) {
      const std::int32_t* block_scores = scores + b * kBlockRows;
      std::int32_t best = block_scores[0];
      for (int r = 1; r < kBlockRows; ++r) best = std::max(best, block_scores[r]);
      if (best <= nearest.floor()) continue;
      for (int r = 0; r < kBlockRows; ++r) nearest.offer(block_scores[r], rows[b * kBlockRows + r]);
    }
  }
}

size_t DescriptorIndex::bytes() const { return blocks_.bytes() + rows_.size() * sizeof(rows_[0]); }

}  // namespace rgbd_recognition
