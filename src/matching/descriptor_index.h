#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "matching/descriptor_clusters.h"
#include "matching/nearest_rows.h"
#include "matching/quantized_descriptors.h"

namespace recognition {

/// How a DescriptorIndex trades accuracy for time.
struct IndexParameters {
  int exact_below = 20000;     ///< descriptors up to which all are compared
  int rows_per_cluster = 128;  ///< above: mean size of the clusters
  int probes = 24;             ///< above: clusters compared with a query
};

/// Sizes of features in metres.
struct SizeRange {
  float min = 0.0f, max = std::numeric_limits<float>::infinity();
  bool meets(const SizeRange& other) const { return min <= other.max && other.min <= max; }
};

/// All models' descriptors in one place, searched by nearest neighbour in Euclidean distance of the quantised
/// descriptors: all of them, or, where they are many, those of the clusters nearest to the query (an inverted file:
/// Sivic and Zisserman, ICCV 2003; Jegou et al., PAMI 2011).
class DescriptorIndex {
 public:
  /// Row numbers of the index count through `models` in order. Every matrix as in quantize(), all of `length` columns.
  /// `sizes`: of each row of each model, metres, 0 where unknown; empty models have none that is known.
  DescriptorIndex(const std::vector<cv::Mat>& models, int length, const IndexParameters& parameters = {},
                  const std::vector<std::vector<float>>& sizes = {});

  /// The `k` nearest rows to each query, as far as they are nearer than `max_distance`. `sizes`, if not empty: blocks of
  /// rows that are all smaller or larger are passed over; rows beside them may have any size.
  std::vector<NearestRows> nearest(const QuantizedRows& queries, int k, double max_distance,
                                   const std::vector<SizeRange>& sizes = {}) const;

  int count() const { return count_; }
  size_t bytes() const;

 private:
  struct Visit;
  struct Queries;
  std::vector<int> clusterRows(const std::vector<cv::Mat>& models);
  void place(const std::vector<cv::Mat>& models, const std::vector<int>& cluster_of_row,
             const std::vector<std::vector<float>>& sizes);
  void searchBatch(const Queries& queries, int first, int end, std::vector<NearestRows>& nearest) const;
  void scan(int cluster, const Queries& queries, const int* begin, const int* end,
            std::vector<NearestRows>& nearest) const;

  IndexParameters parameters_;
  int count_ = 0;
  std::vector<int> first_row_;  ///< of each model
  DescriptorClusters clusters_;
  DescriptorBlocks blocks_;          ///< cluster by cluster, each from a whole block on
  std::vector<int> first_block_;     ///< of each cluster, and the end
  std::vector<std::uint32_t> rows_;  ///< row number of each slot of blocks_; in a cluster by rising size
  std::vector<SizeRange> sizes_;     ///< of each block's rows; empty where no size is known
};

}  // namespace recognition
