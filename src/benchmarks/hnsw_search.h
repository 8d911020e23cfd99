#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace recognition::benchmarks {

/// One setting of hnswlib's index (hierarchical navigable small worlds: Malkov and Yashunin, PAMI 2018).
struct HnswRun {
  int ef = 0;       ///< candidates it keeps while searching
  double ms = 0.0;  ///< for all queries, one thread
  cv::Mat nearest;  ///< CV_32SC1, a row a query: its k nearest rows, nearest first, -1 where there are fewer
};

struct HnswComparison {
  bool available = false;  ///< false: built without hnswlib
  double build_s = 0.0;    ///< all cores
  std::vector<HnswRun> runs;
};

/// `rows` and `queries`: CV_32FC1, a descriptor a row.
HnswComparison searchWithHnsw(const cv::Mat& rows, const cv::Mat& queries, int k);

}  // namespace recognition::benchmarks
