// Compiled for the machine at hand where the compiler can, as hnswlib chooses its instructions when it is compiled.
// Knows nothing of the package's types, whose alignment that may change.
#include "benchmarks/hnsw_search.h"

#ifdef RGBD_WITH_HNSWLIB

#include <chrono>

#include <hnswlib/hnswlib.h>

namespace recognition::benchmarks {
namespace {

constexpr int kLinks = 16, kBuildCandidates = 100;  // M and ef of the construction
constexpr int kSearchCandidates[] = {32, 64, 128, 256, 512};

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

cv::Mat nearestOf(const hnswlib::HierarchicalNSW<float>& index, const cv::Mat& queries, int k) {
  cv::Mat nearest(queries.rows, k, CV_32SC1, cv::Scalar(-1));
  for (int i = 0; i < queries.rows; ++i) {
    auto found = index.searchKnn(queries.ptr<float>(i), static_cast<size_t>(k));  // farthest on top
    for (auto place = static_cast<int>(found.size()) - 1; place >= 0; --place, found.pop())
      nearest.at<int>(i, place) = static_cast<int>(found.top().second);
  }
  return nearest;
}

}  // namespace

HnswComparison searchWithHnsw(const cv::Mat& rows, const cv::Mat& queries, int k) {
  HnswComparison comparison;
  comparison.available = true;
  hnswlib::L2Space space(static_cast<size_t>(rows.cols));
  hnswlib::HierarchicalNSW<float> index(&space, static_cast<size_t>(rows.rows), kLinks, kBuildCandidates, 1);
  auto start = std::chrono::steady_clock::now();
  index.addPoint(rows.ptr<float>(0), 0);
  cv::parallel_for_(cv::Range(1, rows.rows), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) index.addPoint(rows.ptr<float>(i), static_cast<size_t>(i));
  });
  comparison.build_s = secondsSince(start);
  for (const int ef : kSearchCandidates) {
    index.setEf(static_cast<size_t>(ef));
    start = std::chrono::steady_clock::now();
    HnswRun run;
    run.nearest = nearestOf(index, queries, k);
    run.ms = 1e3 * secondsSince(start);
    run.ef = ef;
    comparison.runs.push_back(run);
  }
  return comparison;
}

}  // namespace recognition::benchmarks

#else

namespace recognition::benchmarks {

HnswComparison searchWithHnsw(const cv::Mat&, const cv::Mat&, int) { return {}; }

}  // namespace recognition::benchmarks

#endif
