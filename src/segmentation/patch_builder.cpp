#include "segmentation/patch_builder.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/depth_noise.h"

namespace recognition {

PatchBuilder::PatchBuilder(const SegmentationParameters& parameters, const Extents& limits)
    : parameters_(parameters), limits_(limits) {}

bool PatchBuilder::findComponents(const cv::Mat& depth, const cv::Mat& smooth, const CameraModel& camera,
                                  cv::Mat* labels, cv::Mat* too_large) {
  const int count = cv::connectedComponents(smooth, *labels, 4, CV_32S);
  new_labels_.assign(static_cast<size_t>(count), kUnlabelled);
  boxes_.clear();
  bool all_fit = true;
  std::vector<std::uint8_t> large(static_cast<size_t>(count), 0);
  for (const Patch& patch : describePatches(depth, camera, *labels, count, parameters_.min_pixels)) {
    const auto i = static_cast<size_t>(patch.label);
    const double length = 6.0 * std::sqrt(static_cast<double>(patch.eigenvalues[2]));
    if (tooLarge(patch)) {
      large[i] = 255;
      all_fit = false;
      continue;
    }
    if (length < parameters_.min_size_margin * limits_.sigma_min) continue;
    boxes_.push_back(patch.box);
    new_labels_[i] = static_cast<int>(boxes_.size());
  }
  if (!all_fit) too_large->create(labels->size(), CV_8UC1);
  cv::parallel_for_(cv::Range(0, labels->rows), [&](const cv::Range& part) {
    for (int v = part.start; v < part.end; ++v) {
      int* row = labels->ptr<int>(v);
      if (!all_fit)
        for (int u = 0; u < labels->cols; ++u) too_large->ptr(v)[u] = large[static_cast<size_t>(row[u])];
      for (int u = 0; u < labels->cols; ++u) row[u] = new_labels_[static_cast<size_t>(row[u])];
    }
  });
  return all_fit;
}

bool PatchBuilder::tooLarge(const Patch& patch) const {
  if (limits_.sigma_max <= 0.0) return false;
  if (6.0 * std::sqrt(static_cast<double>(patch.eigenvalues[2])) > parameters_.max_size_margin * limits_.sigma_max)
    return true;
  const double gyration = 3.0 * std::sqrt(static_cast<double>(patch.eigenvalues[0] + patch.eigenvalues[1]));
  return parameters_.size_filter == SizeFilter::kEllipsoid && gyration > parameters_.max_size_margin * limits_.sigma_d;
}

void PatchBuilder::expand(const cv::Mat& inverse, const cv::Mat& barred, cv::Mat* labels) {
  quadrics_.assign(boxes_.size() + 1, InverseDepthQuadric());
  cv::parallel_for_(cv::Range(1, static_cast<int>(quadrics_.size())), [&](const cv::Range& part) {
    for (int i = part.start; i < part.end; ++i)
      fitQuadric(inverse, *labels, i, boxes_[static_cast<size_t>(i - 1)], &quadrics_[static_cast<size_t>(i)]);
  });
  const float bound = static_cast<float>(parameters_.expansion_bound * depthSigma(1.0));
  const auto on_quadric = [&](int label, float, float d, int u, int v) {
    return std::abs(d - quadrics_[static_cast<size_t>(label)].at(u, v)) <= bound;
  };
  grow(inverse, barred, labels, on_quadric);
  const float jump = static_cast<float>(parameters_.jump);
  const auto continuous = [jump](int, float from, float d, int, int) { return std::abs(d - from) <= jump; };
  grow(inverse, barred, labels, continuous);
}

template <typename Joins>
void PatchBuilder::grow(const cv::Mat& inverse, const cv::Mat& barred, cv::Mat* labels, Joins joins) {
  const int cols = labels->cols, rows = labels->rows;
  int* label = labels->ptr<int>();
  const float* d = inverse.ptr<float>();
  const std::uint8_t* bar = barred.ptr();
  const auto visit = [&](int from, int u, int v) {
    const int i = v * cols + u;
    if (label[i] != kUnlabelled || !(d[i] > 0.0f) || bar[i] || !joins(label[from], d[from], d[i], u, v)) return;
    label[i] = label[from];
    next_frontier_.push_back(i);
  };
  frontier_.clear();
  for (int v = 0; v < rows; ++v) {
    for (int u = 0; u < cols; ++u) {
      const int i = v * cols + u;
      if (label[i] <= kUnlabelled) continue;
      const bool inside = (u == 0 || label[i - 1] != kUnlabelled) && (u + 1 == cols || label[i + 1] != kUnlabelled) &&
                          (v == 0 || label[i - cols] != kUnlabelled) &&
                          (v + 1 == rows || label[i + cols] != kUnlabelled);
      if (!inside) frontier_.push_back(i);
    }
  }
  for (int ring = 0; ring < parameters_.expansion_range && !frontier_.empty(); ++ring) {
    next_frontier_.clear();
    for (int i : frontier_) {
      const int u = i % cols, v = i / cols;
      if (u > 0) visit(i, u - 1, v);
      if (u + 1 < cols) visit(i, u + 1, v);
      if (v > 0) visit(i, u, v - 1);
      if (v + 1 < rows) visit(i, u, v + 1);
    }
    frontier_.swap(next_frontier_);
  }
}

std::vector<Patch> PatchBuilder::describe(const cv::Mat& depth, const CameraModel& camera,
                                          const cv::Mat& labels) const {
  return describePatches(depth, camera, labels, static_cast<int>(boxes_.size()) + 1);
}

}  // namespace recognition
