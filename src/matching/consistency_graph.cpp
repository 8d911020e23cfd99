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

/// Part k (21 bits) of a random number, scaled to 0 .. count - 1.
size_t partOf(std::uint64_t random, int k, size_t count) {
  constexpr std::uint64_t kMask = (1u << 21) - 1;
  return static_cast<size_t>(((random >> 21 * k & kMask) * count) >> 21);
}

/// Keeps the bits of `kept` that `other` has too; how many they are.
RGBD_SIMD_CLONES int keepShared(BitWord* kept, const BitWord* other, int words) {
  int count = 0;
  for (int w = 0; w < words; ++w) {
    kept[w] &= other[w];
    count += __builtin_popcountll(kept[w]);
  }
  return count;
}

RGBD_SIMD_CLONES int nthBit(const BitWord* bits, int words, int n) {
  for (int w = 0; w < words; ++w) {
    const int count = __builtin_popcountll(bits[w]);
    if (n >= count) {
      n -= count;
      continue;
    }
    BitWord word = bits[w];
    for (; n > 0; --n) word &= word - 1;
    return w * kWordBits + __builtin_ctzll(word);
  }
  return -1;
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

bool ConsistencyGraph::drawTriangle(const BitWord* row_of_fixed, const std::vector<int>& members, std::uint64_t random,
                                    int (&triangle)[3]) {
  triangle[0] = members[partOf(random, 0, members.size())];
  shared_.assign(row_of_fixed, row_of_fixed + words_);
  for (int k = 1; k < 3; ++k) {
    const BitWord* own = row(triangle[k - 1]);
    int count = keepShared(shared_.data(), own, words_);
    for (int earlier = 0; earlier < k; ++earlier) {  // each is in its own row
      BitWord& word = shared_[static_cast<size_t>(triangle[earlier] / kWordBits)];
      const BitWord bit = BitWord{1} << (triangle[earlier] % kWordBits);
      count -= (word & bit) != 0 ? 1 : 0;
      word &= ~bit;
    }
    if (count == 0) return false;
    triangle[k] = nthBit(shared_.data(), words_, static_cast<int>(partOf(random, k, static_cast<size_t>(count))));
  }
  return true;
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
