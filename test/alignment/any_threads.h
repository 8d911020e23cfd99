#pragma once

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "search/frame_search.h"

namespace recognition {

/// Expects `find`, which gives hypotheses, to give some, and the same with one, two and eight threads.
template <typename Find>
void expectSameForAnyThreads(const Find& find) {
  std::vector<std::vector<VerifiedHypothesis>> runs;
  for (const int threads : {1, 2, 8}) {
    cv::setNumThreads(threads);
    runs.push_back(find());
  }
  cv::setNumThreads(-1);
  ASSERT_FALSE(runs[0].empty());
  for (const auto& run : runs) {
    ASSERT_EQ(run.size(), runs[0].size());
    for (size_t i = 0; i < run.size(); ++i) {
      EXPECT_EQ(run[i].camera_from_object.matrix(), runs[0][i].camera_from_object.matrix());
      EXPECT_EQ(run[i].confidence, runs[0][i].confidence);
      EXPECT_EQ(run[i].rejection, runs[0][i].rejection);
    }
  }
}

}  // namespace recognition
