#include "matching/consistency_graph.h"

#include <algorithm>

#include "core/simd.h"

namespace recognition {
namespace {

constexpr int kRowWork = 250;  // units of WorkBudget, beside two a correspondence

RGBD_SIMD_CLONES int countShared(const BitWord* a, const BitWord* b, int words) {
  int count = 0;
  for (int w = 0; w < words; ++w) count += __builtin_popcountll(a[w] & b[w]);
  return count;
}

}  // namespace

int countBits(const BitWord* bits, int words) { return countShared(bits, bits, words); }

void ConsistencyGraph::reset(const CorrespondenceSet& set, const ConsistencyLimits& limits) {
  set_ = &set;
  limits_ = limits;
  words_ = wordsFor(set.size());
  const auto size = static_cast<size_t>(set.size());
  rows_.resize(std::max(rows_.size(), size * static_cast<size_t>(words_)));
  left_.resize(static_cast<size_t>(words_));
  made_.assign(size, 0);
}

const BitWord* ConsistencyGraph::row(int fixed) {
  BitWord* row = rows_.data() + static_cast<size_t>(fixed) * static_cast<size_t>(words_);
  if (!made_[fixed]) {
    set_->markConsistent(fixed, limits_, row);
    made_[fixed] = 1;
    work_ += kRowWork + 2 * set_->size();
  }
  return row;
}

bool ConsistencyGraph::mayHoldClique(const BitWord* row_of_fixed, int least) {
  std::copy(row_of_fixed, row_of_fixed + words_, left_.begin());
  members_.clear();
  forEachBit(row_of_fixed, words_, [this](int i) { members_.push_back(i); });
  for (bool changed = true; changed;) {
    changed = false;
    size_t kept = 0;
    for (size_t k = 0; k < members_.size(); ++k) {
      const int i = members_[k];
      if (countShared(row(i), left_.data(), words_) > least) {
        members_[kept++] = i;
        continue;
      }
      left_[i / kWordBits] &= ~(BitWord{1} << (i % kWordBits));
      changed = true;
      if (kept + members_.size() - k - 1 <= static_cast<size_t>(least)) return false;
    }
    work_ += static_cast<long>(members_.size()) * (4 * words_ + 8);
    members_.resize(kept);
  }
  return static_cast<int>(members_.size()) > least;
}

long ConsistencyGraph::takeWork() {
  const long work = work_;
  work_ = 0;
  return work;
}

}  // namespace recognition
