#include "matching/descriptor_clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace recognition {
namespace {

constexpr int kMaxBranches = 256;
constexpr int kIterations = 6;
constexpr int kAssignGroups = 2;  // groups in which a descriptor's cluster is looked for

static_assert(kMaxBranches <= kMaxBlocks * kBlockRows, "all branches are scored at once");
constexpr std::int32_t kNoFloor = std::numeric_limits<std::int32_t>::min();

int blocksFor(int rows) { return (rows + kBlockRows - 1) / kBlockRows; }

int bestRow(const DescriptorBlocks& centres, const QuantizedRows& rows, int row) {
  BlockScores found;
  scoreBlocks(centres, 0, centres.blockCount(), rows, row, kNoFloor, &found);
  return static_cast<int>(std::max_element(found.scores, found.scores + centres.blockCount() * kBlockRows) -
                          found.scores);
}

DescriptorBlocks toBlocks(const QuantizedRows& centres) {
  DescriptorBlocks blocks(centres.length);
  blocks.resize(blocksFor(centres.count()));
  for (int i = 0; i < centres.count(); ++i) blocks.set(i, centres, i);
  return blocks;
}

QuantizedRows select(const QuantizedRows& rows, const std::vector<int>& members) {
  QuantizedRows selected;
  selected.length = rows.length;
  for (const int i : members) {
    selected.values.insert(selected.values.end(), rows.row(i), rows.row(i) + rows.length);
    selected.norms.push_back(rows.norms[i]);
    selected.offsets.push_back(rows.offsets[i]);
  }
  return selected;
}

std::vector<int> assignAll(const QuantizedRows& centres, const QuantizedRows& rows) {
  const DescriptorBlocks blocks = toBlocks(centres);
  std::vector<int> assigned(static_cast<size_t>(rows.count()));
  cv::parallel_for_(cv::Range(0, rows.count()), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) assigned[i] = bestRow(blocks, rows, i);
  });
  return assigned;
}

/// Means of the rows assigned to each centre; a centre without rows stays.
void moveCentres(QuantizedRows& centres, const QuantizedRows& rows, const std::vector<int>& assigned) {
  std::vector<std::int32_t> sums(static_cast<size_t>(centres.count()) * centres.length, 0), counts(centres.count(), 0);
  for (int i = 0; i < rows.count(); ++i) {
    std::int32_t* sum = sums.data() + static_cast<size_t>(assigned[i]) * centres.length;
    for (int k = 0; k < centres.length; ++k) sum[k] += rows.row(i)[k];
    ++counts[assigned[i]];
  }
  cv::Mat means(centres.count(), centres.length, CV_32FC1);
  for (int c = 0; c < centres.count(); ++c)
    for (int k = 0; k < centres.length; ++k)
      means.at<float>(c, k) = counts[c] > 0
                                  ? static_cast<float>(sums[static_cast<size_t>(c) * centres.length + k]) / counts[c]
                                  : centres.row(c)[k];
  centres = quantize(means / kDescriptorScale);
}

/// k-means; fewer centres if there are fewer rows.
QuantizedRows trainCentres(const QuantizedRows& rows, int count) {
  std::vector<int> start(std::min(count, rows.count()));
  for (size_t i = 0; i < start.size(); ++i) start[i] = static_cast<int>(i * rows.count() / start.size());
  QuantizedRows centres = select(rows, start);
  if (centres.count() == 0) return centres;
  for (int i = 0; i < kIterations; ++i) moveCentres(centres, rows, assignAll(centres, rows));
  return centres;
}

}  // namespace

DescriptorClusters::DescriptorClusters(const QuantizedRows& sample, int branches)
    : branches_(std::min(branches, kMaxBranches)), groups_(sample.length), clusters_(sample.length) {
  const QuantizedRows centres = trainCentres(sample, branches_);
  groups_ = toBlocks(centres);
  clusters_.resize(branches_ * blocksFor(branches_));
  cluster_of_slot_.resize(static_cast<size_t>(clusters_.blockCount()) * kBlockRows);
  for (size_t slot = 0; slot < cluster_of_slot_.size(); ++slot) {
    const size_t group_slots = static_cast<size_t>(blocksFor(branches_)) * kBlockRows;
    cluster_of_slot_[slot] = static_cast<std::uint32_t>(slot / group_slots * branches_ + slot % group_slots);
  }
  std::vector<std::vector<int>> members(branches_);
  const std::vector<int> assigned = assignAll(centres, sample);
  for (int i = 0; i < sample.count(); ++i) members[assigned[i]].push_back(i);
  for (int group = 0; group < branches_; ++group) {
    const QuantizedRows fine = trainCentres(select(sample, members[group]), branches_);
    for (int i = 0; i < fine.count(); ++i) clusters_.set(group * blocksFor(branches_) * kBlockRows + i, fine, i);
  }
}

int DescriptorClusters::nearestGroups(const QuantizedRows& rows, int row, int wanted, RankedRow* ranked) const {
  BlockScores found;
  scoreBlocks(groups_, 0, groups_.blockCount(), rows, row, kNoFloor, &found);
  for (int group = 0; group < branches_; ++group)
    ranked[group] = rankedRow(found.scores[group], static_cast<std::uint32_t>(group));
  wanted = std::min(wanted, branches_);
  std::partial_sort(ranked, ranked + wanted, ranked + branches_);
  return wanted;
}

std::vector<RankedRow> DescriptorClusters::nearestClusters(const QuantizedRows& rows, int row, int groups,
                                                           int count) const {
  std::array<RankedRow, kMaxBranches> ranked;
  const int near = nearestGroups(rows, row, groups, ranked.data());
  const int blocks = blocksFor(branches_);
  thread_local std::vector<RankedRow> best;  // and some that are not, until they are sorted out
  best.clear();
  const auto wanted = static_cast<size_t>(count);
  std::int32_t floor = kEmptyScore;  // at it no cluster is there
  const auto sortOut = [&] {
    if (best.size() <= wanted) return;
    std::nth_element(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(wanted) - 1, best.end());
    best.resize(wanted);
    floor = scoreOf(best.back()) - 1;  // an equal score of a lower cluster has a chance
  };
  BlockScores found;
  for (int i = 0; i < near; ++i) {
    const int block = static_cast<int>(rowOf(ranked[i])) * blocks;
    scoreBlocks(clusters_, block, blocks, rows, row, floor, &found);
    const std::uint32_t* clusters = cluster_of_slot_.data() + static_cast<size_t>(block) * kBlockRows;
    for (int b = 0; b < blocks; ++b)
      for (unsigned above = found.above[b]; above != 0; above &= above - 1) {
        const int slot = b * kBlockRows + __builtin_ctz(above);
        best.push_back(rankedRow(found.scores[slot], clusters[slot]));
      }
    if (best.size() >= 2 * wanted) sortOut();
  }
  sortOut();
  return best;
}

int DescriptorClusters::assign(const QuantizedRows& rows, int row) const {
  return static_cast<int>(rowOf(nearestClusters(rows, row, kAssignGroups, 1).front()));
}

std::vector<int> DescriptorClusters::nearest(const QuantizedRows& rows, int row, int probes, int first) const {
  const int groups = std::max(kAssignGroups, 2 * static_cast<int>(std::sqrt(branches_)));
  std::vector<RankedRow> nearest = nearestClusters(rows, row, groups, probes);
  const auto sorted = nearest.begin() + std::min<std::ptrdiff_t>(first, static_cast<std::ptrdiff_t>(nearest.size()));
  std::partial_sort(nearest.begin(), sorted, nearest.end());
  std::vector<int> clusters;
  for (const RankedRow ranked : nearest) clusters.push_back(static_cast<int>(rowOf(ranked)));
  return clusters;
}

}  // namespace recognition
