#include "matching/descriptor_index.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace recognition {
namespace {

constexpr int kFirstProbes = 4;    // clusters that a query looks into before all others
constexpr int kMinBatch = 64;      // queries that share a pass over the clusters
constexpr int kTrainingRows = 16;  // descriptors a cluster is trained on

cv::Mat everyNth(const std::vector<cv::Mat>& models, int step) {
  cv::Mat sample;
  int row = 0;
  for (const cv::Mat& model : models)
    for (int i = 0; i < model.rows; ++i, ++row)
      if (row % step == 0) sample.push_back(quantizedDescriptors(model.row(i)));
  return sample;
}

}  // namespace

/// A query that looks into a cluster.
struct DescriptorIndex::Visit {
  int turn;  ///< of the cluster: all have a first one, then all a second one
  int query;
};

struct DescriptorIndex::Queries {
  const QuantizedRows& rows;
  const std::vector<SizeRange>& sizes;
};

DescriptorIndex::DescriptorIndex(const std::vector<cv::Mat>& models, int length, const IndexParameters& parameters,
                                 const std::vector<std::vector<float>>& sizes)
    : parameters_(parameters), blocks_(length) {
  for (const cv::Mat& model : models) {
    first_row_.push_back(count_);
    count_ += model.rows;
  }
  place(models, clusterRows(models), sizes);
}

std::vector<int> DescriptorIndex::clusterRows(const std::vector<cv::Mat>& models) {
  std::vector<int> cluster_of_row(static_cast<size_t>(count_), 0);
  if (count_ <= parameters_.exact_below) return cluster_of_row;
  const int branches = static_cast<int>(std::sqrt(static_cast<double>(count_) / parameters_.rows_per_cluster)) + 1;
  clusters_ =
      DescriptorClusters(quantize(everyNth(models, count_ / (kTrainingRows * branches * branches) + 1)), branches);
  cv::parallel_for_(cv::Range(0, static_cast<int>(models.size())), [&](const cv::Range& range) {
    for (int model = range.start; model < range.end; ++model) {
      const QuantizedRows rows = quantize(models[model]);
      for (int i = 0; i < rows.count(); ++i) cluster_of_row[first_row_[model] + i] = clusters_.assign(rows, i);
    }
  });
  return cluster_of_row;
}

void DescriptorIndex::place(const std::vector<cv::Mat>& models, const std::vector<int>& cluster_of_row,
                            const std::vector<std::vector<float>>& sizes) {
  std::vector<int> in_cluster(static_cast<size_t>(std::max(clusters_.count(), 1)), 0);
  for (const int cluster : cluster_of_row) ++in_cluster[cluster];
  first_block_.assign(1, 0);
  for (const int size : in_cluster) first_block_.push_back(first_block_.back() + (size + kBlockRows - 1) / kBlockRows);
  blocks_.resize(first_block_.back());
  rows_.resize(static_cast<size_t>(first_block_.back()) * kBlockRows);

  std::vector<float> size_of_row(static_cast<size_t>(count_), 0.0f);
  for (size_t model = 0; model < sizes.size(); ++model)
    std::copy(sizes[model].begin(), sizes[model].end(), size_of_row.begin() + first_row_[model]);
  std::vector<int> by_size(static_cast<size_t>(count_));
  std::iota(by_size.begin(), by_size.end(), 0);
  if (!sizes.empty())
    std::stable_sort(by_size.begin(), by_size.end(), [&](int a, int b) { return size_of_row[a] < size_of_row[b]; });
  std::vector<int> next_slot, slots(static_cast<size_t>(count_));
  for (size_t cluster = 0; cluster < in_cluster.size(); ++cluster)
    next_slot.push_back(first_block_[cluster] * kBlockRows);
  for (const int row : by_size) slots[row] = next_slot[cluster_of_row[row]]++;
  cv::parallel_for_(cv::Range(0, static_cast<int>(models.size())), [&](const cv::Range& range) {
    for (int model = range.start; model < range.end; ++model) {
      const QuantizedRows rows = quantize(models[model]);
      for (int i = 0; i < rows.count(); ++i) {
        const int row = first_row_[model] + i;
        blocks_.set(slots[row], rows, i);
        rows_[slots[row]] = static_cast<std::uint32_t>(row);
      }
    }
  });
  if (sizes.empty()) return;
  sizes_.assign(static_cast<size_t>(first_block_.back()), {std::numeric_limits<float>::infinity(), 0.0f});
  for (int row = 0; row < count_; ++row) {
    SizeRange& range = sizes_[static_cast<size_t>(slots[row] / kBlockRows)];
    const bool known = size_of_row[row] > 0.0f;
    range.min = known ? std::min(range.min, size_of_row[row]) : 0.0f;
    range.max = known ? std::max(range.max, size_of_row[row]) : std::numeric_limits<float>::infinity();
  }
}

std::vector<NearestRows> DescriptorIndex::nearest(const QuantizedRows& queries, int k, double max_distance,
                                                  const std::vector<SizeRange>& sizes) const {
  std::vector<NearestRows> nearest;
  for (const std::int32_t norm : queries.norms) nearest.emplace_back(k, scoreFloor(norm, max_distance));
  // The fewer the batches, the less is read from memory. Results do not depend on them: each query stands alone.
  const int batch = std::max(kMinBatch, (queries.count() + cv::getNumThreads() - 1) / cv::getNumThreads());
  const int batches = (queries.count() + batch - 1) / batch;
  cv::parallel_for_(cv::Range(0, batches), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const int first = i * batch, end = std::min(first + batch, queries.count());
      searchBatch({queries, sizes}, first, end, nearest);
      for (int query = first; query < end; ++query) nearest[query].finish();
    }
  });
  return nearest;
}

void DescriptorIndex::searchBatch(const Queries& queries, int first, int end, std::vector<NearestRows>& nearest) const {
  if (clusters_.count() == 0) {
    std::vector<int> all(static_cast<size_t>(end - first));
    std::iota(all.begin(), all.end(), first);
    return scan(0, queries, all.data(), all.data() + all.size(), nearest);
  }
  // Cluster by cluster, so that each is read from memory once for all queries that look into it; but the nearest of
  // each query before all others, as they leave the others little chance.
  const int count = clusters_.count();
  std::vector<Visit> visits;
  std::vector<int> begins(2 * static_cast<size_t>(count) + 1, 0);
  for (int query = first; query < end; ++query) {
    int rank = 0;
    for (const int cluster : clusters_.nearest(queries.rows, query, parameters_.probes, kFirstProbes)) {
      visits.push_back({rank++ < kFirstProbes ? cluster : count + cluster, query});
      ++begins[static_cast<size_t>(visits.back().turn) + 1];
    }
  }
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  std::vector<int> sorted(visits.size()), next = begins;
  for (const Visit& visit : visits) sorted[next[visit.turn]++] = visit.query;
  for (int turn = 0; turn < 2 * count; ++turn)
    scan(turn % count, queries, sorted.data() + begins[turn], sorted.data() + begins[turn + 1], nearest);
}

void DescriptorIndex::scan(int cluster, const Queries& queries, const int* begin, const int* end,
                           std::vector<NearestRows>& nearest) const {
  BlockScores found;
  const bool sized = !sizes_.empty() && !queries.sizes.empty();
  for (int block = first_block_[cluster]; block < first_block_[cluster + 1]; block += kMaxBlocks) {
    const int stretch_end = std::min(block + kMaxBlocks, first_block_[cluster + 1]);
    for (const int* query = begin; query != end; ++query) {
      int first = block, last = stretch_end;
      if (sized) {  // blocks rise in size
        const SizeRange& wanted = queries.sizes[static_cast<size_t>(*query)];
        while (first < last && !sizes_[first].meets(wanted)) ++first;
        while (first < last && !sizes_[last - 1].meets(wanted)) --last;
        if (first == last) continue;
      }
      scoreBlocks(blocks_, first, last - first, queries.rows, *query, nearest[*query].floor(), &found);
      nearest[*query].offer(found, rows_.data() + static_cast<size_t>(first) * kBlockRows, last - first);
    }
  }
}

size_t DescriptorIndex::bytes() const {
  return clusters_.bytes() + blocks_.bytes() + rows_.size() * sizeof(rows_[0]) +
         first_block_.size() * sizeof(first_block_[0]) + sizes_.size() * sizeof(sizes_[0]);
}

}  // namespace recognition
