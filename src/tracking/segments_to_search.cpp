#include "tracking/segments_to_search.h"

#include <algorithm>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "tracking/explained_pixels.h"

namespace recognition {
namespace {

constexpr int kCell = 8;                 // pixels of the depth image
constexpr double kGrayChange = 25.0;     // of 255; the noise of a mean over 8 x 8 pixels is below 3
constexpr double kDepthChange = 0.03;    // of the distance; of a median of 9 pixels
constexpr int kMinChanged = 3;           // cells
constexpr double kChangedShare = 0.15;   // of a segment's cells, from which it is searched again
constexpr double kExplainedShare = 0.5;  // of a segment's pixels, from which it is a track's
constexpr size_t kMaxInSearch = 8;       // frames

cv::Mat shrunk(const cv::Mat& image, cv::Size size, int interpolation) {
  cv::Mat small;
  cv::resize(image, small, size, 0, 0, interpolation);
  return small;
}

cv::Size cellsFor(const cv::Mat& depth) { return {std::max(1, depth.cols / kCell), std::max(1, depth.rows / kCell)}; }

/// Labels of `keep` (by old label) numbered anew, all others and what is explained without a label.
Segmentation renumbered(const Segmentation& segmentation, const cv::Mat& depth, const CameraModel& camera,
                        const cv::Mat& explained, const std::vector<bool>& keep) {
  std::vector<int> numbers(keep.size(), kUnlabelled);
  int count = 1;
  for (size_t label = 1; label < keep.size(); ++label)
    if (keep[label]) numbers[label] = count++;
  Segmentation left;
  left.edges = segmentation.edges;
  left.labels = segmentation.labels.clone();
  left.labels.forEach<int>([&](int& label, const int* at) {
    if (label <= kUnlabelled) return;
    const bool is_explained = !explained.empty() && explained.at<std::uint8_t>(at[0], at[1]) != 0;
    label = is_explained ? kUnlabelled : numbers[static_cast<size_t>(label)];
  });
  left.patches = describePatches(depthInMetres(depth), camera, left.labels, count);
  return left;
}

}  // namespace

SegmentsToSearch::Cells SegmentsToSearch::cellsOf(const RgbdFrame& frame) {
  const cv::Size size = cellsFor(frame.depth);
  const int k = frame.colorPerDepthPixel();
  const cv::Mat covered = frame.color(cv::Rect(0, 0, frame.depth.cols * k, frame.depth.rows * k));
  Cells cells;
  cells.gray = toGray(shrunk(covered, size, cv::INTER_AREA), frame.color_order);
  cells.depth = depthInMetres(shrunk(frame.depth, size, cv::INTER_NEAREST));
  cv::medianBlur(cells.depth, cells.depth, 3);
  return cells;
}

/// 255 for each cell that looks otherwise; holes in depth come and go.
cv::Mat SegmentsToSearch::changed(const Cells& now, const Cells& before) {
  cv::Mat difference;
  cv::absdiff(now.gray, before.gray, difference);
  cv::Mat changed = difference > kGrayChange;
  cv::absdiff(now.depth, before.depth, difference);
  changed |= (difference > kDepthChange * before.depth) & (now.depth > 0.0f) & (before.depth > 0.0f);
  return changed;
}

void SegmentsToSearch::forgetIfBackwards(double stamp) {
  if (stamp < last_) reset();
  last_ = stamp;
}

void SegmentsToSearch::reset() {
  all_ = true;
  unsearched_ = false;
  looked_ = known_ = {};
  in_search_.clear();
}

bool SegmentsToSearch::isWorthALook(double stamp, const RgbdFrame& frame, const cv::Mat& explained) {
  forgetIfBackwards(stamp);
  if (wantsAll(stamp) || unsearched_ || looked_.gray.empty() || looked_.gray.size() != cellsFor(frame.depth))
    return true;
  cv::Mat changes = changed(cellsOf(frame), looked_);
  if (explained.size() == frame.depth.size()) {
    const cv::Mat cells = shrunk(explained, changes.size(), cv::INTER_NEAREST);
    changes.setTo(0, cells == kExplainedPixel);
    changes.setTo(255, cells == kUnconfirmedPixel);
  }
  return cv::countNonZero(changes) >= kMinChanged;
}

Segmentation SegmentsToSearch::select(double stamp, const RgbdFrame& frame, const Segmentation& segmentation,
                                      const cv::Mat& explained) {
  requireSameSize(segmentation, frame.depth);
  forgetIfBackwards(stamp);
  Cells cells = cellsOf(frame);
  if (!known_.gray.empty() && known_.gray.size() != cells.gray.size()) reset();
  const bool whole = wantsAll(stamp);
  const bool is_told = !whole && explained.size() == frame.depth.size();
  const cv::Mat known_pixels = is_told ? cv::Mat(explained == kExplainedPixel) : cv::Mat();
  const cv::Mat labels = shrunk(segmentation.labels, cells.gray.size(), cv::INTER_NEAREST);
  std::vector<int> all(segmentation.patches.size() + 1, 0), of_tracks = all, in_cells = all, other = all;
  if (!known_pixels.empty())
    for (int v = 0; v < known_pixels.rows; ++v)
      for (int u = 0; u < known_pixels.cols; ++u) {
        const int label = segmentation.labels.at<int>(v, u);
        if (label > 0 && known_pixels.at<std::uint8_t>(v, u)) ++of_tracks[static_cast<size_t>(label)];
      }
  cv::Mat changes = known_.gray.empty() ? cv::Mat() : changed(cells, known_);
  if (is_told && !changes.empty())
    changes.setTo(255, shrunk(explained, changes.size(), cv::INTER_NEAREST) == kUnconfirmedPixel);
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      const int label = labels.at<int>(v, u);
      if (label <= 0) continue;
      ++in_cells[static_cast<size_t>(label)];
      const bool is_known = !changes.empty() && known_.mask.at<std::uint8_t>(v, u) && !changes.at<std::uint8_t>(v, u);
      other[static_cast<size_t>(label)] += is_known ? 0 : 1;
    }
  std::vector<bool> keep(all.size(), false);
  for (const Patch& patch : segmentation.patches) {
    const auto label = static_cast<size_t>(patch.label);
    const bool is_track = of_tracks[label] > kExplainedShare * patch.pixels;
    const bool is_new = in_cells[label] == 0 || other[label] > kChangedShare * in_cells[label];
    keep[label] = whole || (!is_track && is_new);
  }
  Segmentation left =
      whole ? segmentation : renumbered(segmentation, frame.depth, frame.depthCamera(), known_pixels, keep);
  if (whole) last_whole_ = stamp;
  all_ = false;
  cells.mask = shrunk(left.labels, cells.gray.size(), cv::INTER_NEAREST) > 0;
  looked_ = cells;
  unsearched_ = !left.patches.empty();
  if (unsearched_) in_search_[stamp] = cells;
  while (in_search_.size() > kMaxInSearch) in_search_.erase(in_search_.begin());
  return left;
}

void SegmentsToSearch::searched(double stamp, bool in_full) {
  const auto found = in_search_.find(stamp);
  if (found == in_search_.end()) return;
  const Cells cells = found->second;
  in_search_.erase(in_search_.begin(), std::next(found));
  if (!in_full) return;
  if (known_.gray.empty())
    known_ = {cells.gray.clone(), cells.depth.clone(), cv::Mat::zeros(cells.mask.size(), CV_8UC1)};
  cells.gray.copyTo(known_.gray, cells.mask);
  cells.depth.copyTo(known_.depth, cells.mask);
  known_.mask |= cells.mask;
  if (cells.gray.data == looked_.gray.data) unsearched_ = false;
}

}  // namespace recognition
