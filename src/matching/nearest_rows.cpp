#include "matching/nearest_rows.h"

#include <algorithm>

namespace recognition {

void NearestRows::offer(const BlockScores& found, const std::uint32_t* rows, int blocks) {
  for (int b = 0; b < blocks; ++b)
    for (unsigned above = found.above[b]; above != 0; above &= above - 1) {
      const int i = b * kBlockRows + __builtin_ctz(above);
      offer(found.scores[i], rows[i]);
    }
}

void NearestRows::keepBest() {
  if (rows_.size() <= k_) return;
  const auto last = rows_.begin() + static_cast<std::ptrdiff_t>(k_) - 1;
  std::nth_element(rows_.begin(), last, rows_.end());
  rows_.resize(k_);
  floor_ = std::max(floor_, scoreOf(rows_.back()) - 1);
}

void NearestRows::finish() {
  if (k_ <= kMaxInserted) return;  // sorted already
  keepBest();
  std::sort(rows_.begin(), rows_.end());
}

}  // namespace recognition
