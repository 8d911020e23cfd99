#pragma once

#include <array>
#include <string>
#include <vector>

#include "rgbd_recognition/verification/verified_hypothesis.h"

namespace recognition {

/// How many hypotheses of each source came how far.
struct SearchFunnel {
  struct Counts {
    std::array<int, kTestLevels> reached{};  ///< by TestLevel; [0] are all that were proposed
    int accepted = 0;
  };
  std::array<Counts, kHypothesisSources> by_source;  ///< by HypothesisSource

  void add(const VerifiedHypothesis& hypothesis);
};

/// What the search of a frame did and did not do.
struct SearchReport {
  SearchFunnel funnel;
  double work_ms = 0.0;               ///< work spent, in milliseconds of one core of 2.5 GHz; see WorkBudget
  std::vector<std::string> left_out;  ///< what the budget cut, in words; empty: nothing
};

}  // namespace recognition
