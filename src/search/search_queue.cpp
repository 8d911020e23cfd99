#include "search/search_queue.h"

#include <algorithm>

namespace recognition {

bool SearchQueue::isBetter(const Entry& a, const Entry& b) {
  if (a.bound != b.bound) return a.bound > b.bound;
  const size_t size_a = a.tested.verified.hypothesis.consensus.size();
  const size_t size_b = b.tested.verified.hypothesis.consensus.size();
  return size_a != size_b ? size_a > size_b : a.arrival < b.arrival;
}

void SearchQueue::push(TestedHypothesis tested, double bound) {
  entries_.push_back({std::move(tested), bound, arrivals_++});
  sorted_ = false;
}

std::vector<TestedHypothesis> SearchQueue::take(size_t count) {
  if (!sorted_)
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return isBetter(b, a); });
  sorted_ = true;
  std::vector<TestedHypothesis> best;
  for (; best.size() < count && !entries_.empty(); entries_.pop_back())
    best.push_back(std::move(entries_.back().tested));
  return best;
}

}  // namespace recognition
