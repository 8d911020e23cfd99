#pragma once

#include <vector>

#include "verification/acceptance_rule.h"
#include "verification/pose_verification.h"

namespace recognition {

/// Hypotheses that wait for their test, the best first: those with the highest bound of their confidence, of equal ones
/// those of the largest consensus, then in the order in which they came.
class SearchQueue {
 public:
  void push(TestedHypothesis tested, double bound);
  bool empty() const { return entries_.empty(); }
  size_t size() const { return entries_.size(); }

  /// Takes the best `count` out, fewer if there are fewer.
  std::vector<TestedHypothesis> take(size_t count);

 private:
  struct Entry {
    TestedHypothesis tested;
    double bound;
    size_t arrival;
  };
  static bool isBetter(const Entry& a, const Entry& b);

  std::vector<Entry> entries_;  // sorted, the best last
  bool sorted_ = true;
  size_t arrivals_ = 0;
};

}  // namespace recognition
