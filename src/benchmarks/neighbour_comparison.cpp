#include "benchmarks/neighbour_comparison.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <vector>

#include "benchmarks/hnsw_search.h"
#include "matching/descriptor_index.h"

namespace recognition::benchmarks {
namespace {

constexpr int kRepeats = 5;  // of which the fastest counts

/// Row numbers, nearest first, -1 where there are fewer.
cv::Mat rowsOf(const std::vector<NearestRows>& nearest, int k) {
  cv::Mat rows(static_cast<int>(nearest.size()), k, CV_32SC1, cv::Scalar(-1));
  for (int i = 0; i < rows.rows; ++i) {
    const auto& found = nearest[static_cast<size_t>(i)].rows();
    for (size_t j = 0; j < found.size(); ++j) rows.at<int>(i, static_cast<int>(j)) = static_cast<int>(rowOf(found[j]));
  }
  return rows;
}

/// Share of the first `count` of the exact answer that are among the first `count` found.
double recall(const cv::Mat& exact, const cv::Mat& found, int count) {
  int right = 0, all = 0;
  for (int i = 0; i < exact.rows; ++i)
    for (int j = 0; j < count; ++j) {
      const int* row = found.ptr<int>(i);
      all += exact.at<int>(i, j) >= 0;
      right += exact.at<int>(i, j) >= 0 && std::find(row, row + count, exact.at<int>(i, j)) != row + count;
    }
  return static_cast<double>(right) / std::max(1, all);
}

nlohmann::json line(double ms, const cv::Mat& exact, const cv::Mat& found) {
  return {{"ms", ms}, {"recall_at_1", recall(exact, found, 1)}, {"recall_at_k", recall(exact, found, exact.cols)}};
}

}  // namespace

nlohmann::json compareNeighbourSearch(const ModelDatabase& database, DescriptorType type, const cv::Mat& queries, int k,
                                      bool with_hnsw) {
  constexpr double kAnyDistance = 2.0;  // of unit vectors
  std::vector<cv::Mat> models;
  cv::Mat all;
  for (const auto& object : database.objects) {
    models.push_back(object->features.at(type).descriptors);
    all.push_back(unitDescriptors(quantizedDescriptors(models.back())));
  }
  const QuantizedRows quantized = quantize(queries);
  IndexParameters exact_search;
  exact_search.exact_below = std::numeric_limits<int>::max();
  const int threads = cv::getNumThreads();
  const cv::Mat exact =
      rowsOf(DescriptorIndex(models, queries.cols, exact_search).nearest(quantized, k, kAnyDistance), k);
  const DescriptorIndex index(models, queries.cols);
  cv::setNumThreads(1);
  std::vector<NearestRows> nearest;
  double ms = std::numeric_limits<double>::max();
  for (int i = 0; i < kRepeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    nearest = index.nearest(quantized, k, kAnyDistance);
    ms = std::min(ms, 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  cv::setNumThreads(threads);
  nlohmann::json comparison = {{"k", k}, {"rows", all.rows}, {"index", line(ms, exact, rowsOf(nearest, k))}};
  const HnswComparison hnsw = with_hnsw ? searchWithHnsw(all, queries, k) : HnswComparison();
  if (!hnsw.available) return comparison;
  comparison["hnsw_build_s"] = hnsw.build_s;
  for (const HnswRun& run : hnsw.runs)
    comparison["hnsw_ef" + std::to_string(run.ef)] = line(run.ms, exact, run.nearest);
  return comparison;
}

}  // namespace recognition::benchmarks
