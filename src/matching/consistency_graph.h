#pragma once

#include <vector>

#include "matching/geometric_consistency.h"

namespace recognition {

/// Which correspondences of a set agree with one another, eq. (8): T_3 of each of them as a row of bits, made when
/// first asked for. Not for concurrent use.
class ConsistencyGraph {
 public:
  /// Starts over with another set, which must outlive this use. Keeps its memory.
  void reset(const CorrespondenceSet& set, const ConsistencyLimits& limits);

  int words() const { return words_; }
  /// Those consistent with `fixed`, itself among them; valid until reset().
  const BitWord* row(int fixed);

  /// Whether b is in row(a).
  bool agree(int a, int b) { return (row(a)[b / kWordBits] >> (b % kWordBits) & 1) != 0; }

  /// Three members of `row` that agree with one another (numbers of the set), by three random numbers of 21 bits; false
  /// where those drawn first have no third.
  bool drawTriangle(const BitWord* row, const std::vector<int>& members, std::uint64_t random, int (&triangle)[3]);

  /// Ours, beyond the paper: whether more than `least` of the members of `row` may agree each with the others. Members
  /// that agree with too few of the rest are taken away until none is left to take; a consensus of right
  /// correspondences stays, as it is a clique, while the many that fit only the two fixed ones go.
  bool mayHoldClique(const BitWord* row, int least);

  /// Units of WorkBudget spent since the last call.
  long takeWork();

 private:
  const CorrespondenceSet* set_ = nullptr;
  ConsistencyLimits limits_;
  int words_ = 0;
  long work_ = 0;
  std::vector<BitWord> rows_;
  std::vector<std::uint8_t> made_;
  std::vector<BitWord> left_, shared_;
  std::vector<int> members_;
};

int countBits(const BitWord* bits, int words);

}  // namespace recognition
