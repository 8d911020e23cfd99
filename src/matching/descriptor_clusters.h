#pragma once

#include <vector>

#include "matching/nearest_rows.h"
#include "matching/quantized_descriptors.h"

namespace recognition {

/// Descriptors clustered by k-means on two levels: `branches` groups of `branches` clusters each. Deterministic for any
/// number of threads.
class DescriptorClusters {
 public:
  DescriptorClusters() = default;
  /// Trains on `sample`; at most 256 branches.
  DescriptorClusters(const QuantizedRows& sample, int branches);

  int count() const { return branches_ * branches_; }
  size_t bytes() const {
    return groups_.bytes() + clusters_.bytes() + cluster_of_slot_.size() * sizeof(cluster_of_slot_[0]);
  }

  /// The cluster that a descriptor belongs to.
  int assign(const QuantizedRows& rows, int row) const;

  /// The `probes` clusters nearest to a descriptor, looked for in the nearest of the groups: the `first` nearest
  /// in order, then the others in none.
  std::vector<int> nearest(const QuantizedRows& rows, int row, int probes, int first) const;

 private:
  int nearestGroups(const QuantizedRows& rows, int row, int wanted, RankedRow* ranked) const;
  std::vector<RankedRow> nearestClusters(const QuantizedRows& rows, int row, int groups, int count) const;

  int branches_ = 0;
  DescriptorBlocks groups_;    ///< centres of the groups
  DescriptorBlocks clusters_;  ///< centres of the clusters, each group's from a whole block on
  std::vector<std::uint32_t> cluster_of_slot_;
};

}  // namespace recognition
