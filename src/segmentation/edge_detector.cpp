#include "segmentation/edge_detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/simd.h"
#include "segmentation/scan_line_splitter.h"

namespace recognition {
namespace {

constexpr int kLinesPerTask = 16;
constexpr int kDirections = 4;
constexpr int kSupportWindow = 5;  ///< pixels
constexpr int kRows = 0;
constexpr std::array<int, kDirections> kColumnStep = {0, 0, 1, -1};  ///< columns, descending, ascending: du per row

/// What one thread works with.
struct Workspace {
  explicit Workspace(const SegmentationParameters& parameters) : splitter(parameters) {}
  ScanLineSplitter splitter;
  std::vector<float> lines;  ///< kLinesPerTask scan-lines, each contiguous
};

/// kLinesPerTask neighbouring scan-lines of one direction. Lines other than rows are named by the column in which they
/// meet (or would meet) row 0.
struct Task {
  int direction = 0;
  int begin = 0;
};

std::uint8_t code(EdgeType type) { return static_cast<std::uint8_t>(type); }

/// One pixel's edge from those of the four directions (rule: EdgeDetector::detect).
RGBD_SIMD_CLONES void combineDirections(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                                        const std::uint8_t* d, std::uint8_t* out, int n) {
  for (int i = 0; i < n; ++i) {
    const int jump = (a[i] == 1) | (b[i] == 1) | (c[i] == 1) | (d[i] == 1);
    const int convex = (a[i] == 2) + (b[i] == 2) + (c[i] == 2) + (d[i] == 2);
    const int concave = (a[i] == 3) + (b[i] == 3) + (c[i] == 3) + (d[i] == 3);
    const int crease = concave > convex ? 3 : (convex > 0 ? 2 : 0);
    out[i] = static_cast<std::uint8_t>(jump ? 1 : crease);
  }
}

RGBD_SIMD_CLONES void dropUnsupported(const std::uint8_t* support, int least, std::uint8_t* edges, int n) {
  for (int i = 0; i < n; ++i) edges[i] = edges[i] == 1 || support[i] >= least ? edges[i] : 0;
}

}  // namespace

class EdgeDetector::Impl {
 public:
  explicit Impl(const SegmentationParameters& parameters) : parameters_(parameters) {}

  void detect(const cv::Mat& range, const CameraModel& camera, cv::Mat* edges) {
    CV_Assert(range.type() == CV_32FC1);
    prepare(range, camera);
    cv::parallel_for_(cv::Range(0, static_cast<int>(tasks_.size())), [&](const cv::Range& part) {
      std::unique_ptr<Workspace> workspace = take();
      for (int i = part.start; i < part.end; ++i) run(tasks_[static_cast<size_t>(i)], workspace.get());
      give(std::move(workspace));
    });
    edges->create(range.size(), CV_8UC1);
    for (int v = 0; v < range.rows; ++v)
      combineDirections(found_[0].ptr(v), found_[1].ptr(v), found_[2].ptr(v), found_[3].ptr(v), edges->ptr(v),
                        range.cols);
    if (parameters_.crease_support > 1) dropLoneCreases(edges);
  }

 private:
  void prepare(const cv::Mat& range, const CameraModel& camera) {
    const double x = 1.0 / camera.fx, y = 1.0 / camera.fy;
    pitch_ = {x, y, std::hypot(x, y), std::hypot(x, y)};
    range_ = range;
    for (cv::Mat& image : found_) {
      image.create(range.size(), CV_8UC1);
      image.setTo(code(EdgeType::kNone));
    }
    if (range.size() == tasks_size_) return;
    tasks_size_ = range.size();
    tasks_.clear();
    const int w = range.cols, h = range.rows;
    const std::array<cv::Range, kDirections> lines = {cv::Range(0, h), cv::Range(0, w), cv::Range(1 - h, w),
                                                      cv::Range(0, w + h - 1)};
    for (int direction = 0; direction < kDirections; ++direction)
      for (int begin = lines[direction].start; begin < lines[direction].end; begin += kLinesPerTask)
        tasks_.push_back({direction, begin});
  }

  void run(const Task& task, Workspace* workspace) {
    if (task.direction == kRows) {
      for (int v = task.begin; v < std::min(task.begin + kLinesPerTask, range_.rows); ++v) {
        workspace->splitter.split(range_.ptr<float>(v), range_.cols, pitch_[kRows]);
        for (const EdgePoint& edge : workspace->splitter.edges())
          found_[kRows].at<std::uint8_t>(v, edge.index) = code(edge.type);
      }
      return;
    }
    gather(task, workspace);
    const int w = range_.cols, h = range_.rows, step = kColumnStep[task.direction];
    for (int j = 0; j < kLinesPerTask; ++j) {
      const int u0 = task.begin + j;  // column u0 + step v in [0, w)
      const int v_begin = step > 0 ? std::max(0, -u0) : (step < 0 ? std::max(0, u0 - w + 1) : 0);
      const int v_end = step > 0 ? std::min(h, w - u0) : (step < 0 ? std::min(h, u0 + 1) : (u0 < w ? h : 0));
      if (v_end <= v_begin) continue;
      workspace->splitter.split(workspace->lines.data() + static_cast<size_t>(j) * h + v_begin, v_end - v_begin,
                                pitch_[task.direction]);
      for (const EdgePoint& edge : workspace->splitter.edges()) {
        const int v = v_begin + edge.index;
        found_[task.direction].at<std::uint8_t>(v, u0 + step * v) = code(edge.type);
      }
    }
  }

  /// Row v of the image gives sample v of each line.
  void gather(const Task& task, Workspace* workspace) const {
    const int w = range_.cols, h = range_.rows, step = kColumnStep[task.direction];
    workspace->lines.resize(static_cast<size_t>(kLinesPerTask) * h);
    for (int v = 0; v < h; ++v) {
      const int u0 = task.begin + step * v;
      const float* row = range_.ptr<float>(v);
      float* to = workspace->lines.data() + v;
      const int j_end = std::min(kLinesPerTask, w - u0);
      for (int j = std::max(0, -u0); j < j_end; ++j) to[static_cast<size_t>(j) * h] = row[u0 + j];
    }
  }

  void dropLoneCreases(cv::Mat* edges) {
    cv::threshold(*edges, present_, 0, 1, cv::THRESH_BINARY);
    cv::boxFilter(present_, support_, CV_8U, {kSupportWindow, kSupportWindow}, {-1, -1}, false, cv::BORDER_CONSTANT);
    for (int v = 0; v < edges->rows; ++v)
      dropUnsupported(support_.ptr(v), parameters_.crease_support, edges->ptr(v), edges->cols);
  }

  std::unique_ptr<Workspace> take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (idle_.empty()) return std::make_unique<Workspace>(parameters_);
    std::unique_ptr<Workspace> workspace = std::move(idle_.back());
    idle_.pop_back();
    return workspace;
  }

  void give(std::unique_ptr<Workspace> workspace) {
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_.push_back(std::move(workspace));
  }

  const SegmentationParameters parameters_;
  cv::Mat range_;
  std::array<double, kDirections> pitch_{};  ///< between neighbours of a scan-line, at z = 1
  std::array<cv::Mat, kDirections> found_;   ///< edges a direction; no two lines of one direction share a pixel
  cv::Mat present_, support_;                ///< CV_8UC1: 1 at edges, their number around
  std::vector<Task> tasks_;
  cv::Size tasks_size_;
  std::mutex mutex_;  ///< of idle_
  std::vector<std::unique_ptr<Workspace>> idle_;
};

EdgeDetector::EdgeDetector(const SegmentationParameters& parameters) : impl_(std::make_unique<Impl>(parameters)) {}
EdgeDetector::~EdgeDetector() = default;
void EdgeDetector::detect(const cv::Mat& range, const CameraModel& camera, cv::Mat* edges) {
  impl_->detect(range, camera, edges);
}

}  // namespace recognition
