#include "training/object_region.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr float kBoardCell = 0.005f;  // of the map of the board, metres
constexpr int kPixelStep = 2;
constexpr double kShareOfViews = 0.15;  // in which a cell must be occupied: leaves passing hands out
constexpr float kMargin = 0.01f;        // metres around what was found
constexpr int kMin = 4;                 // cells

// Counts, for each cell of the board, the views that see something above it.
cv::Mat countOccupied(const std::vector<ObjectView>& views, const RecordingParameters& parameters, int half) {
  cv::Mat counts(2 * half + 1, 2 * half + 1, CV_32SC1, cv::Scalar(0));
  for (const ObjectView& view : views) {
    cv::Mat seen(counts.size(), CV_8UC1, cv::Scalar(0));
    for (int v = 0; v < view.depth.rows; v += kPixelStep)
      for (int u = 0; u < view.depth.cols; u += kPixelStep) {
        if (!(view.depth.at<float>(v, u) > 0.0f)) continue;
        const Eigen::Vector3f p = view.worldPoint(u, v);
        const int x = cvRound(p.x() / kBoardCell) + half, y = cvRound(p.y() / kBoardCell) + half;
        if (p.z() > parameters.plane_margin && p.z() < parameters.max_height && x >= 0 && y >= 0 && x < seen.cols &&
            y < seen.rows)
          seen.at<uchar>(y, x) = 1;
      }
    cv::add(counts, seen, counts, cv::noArray(), CV_32S);
  }
  return counts;
}

float highestIn(const std::vector<ObjectView>& views, const ObjectRegion& region) {
  std::vector<float> heights;
  for (const ObjectView& view : views)
    for (int v = 0; v < view.depth.rows; v += kPixelStep)
      for (int u = 0; u < view.depth.cols; u += kPixelStep)
        if (view.depth.at<float>(v, u) > 0.0f) {
          const Eigen::Vector3f p = view.worldPoint(u, v);
          if (region.contains(p)) heights.push_back(p.z());
        }
  if (heights.empty()) return region.bottom;
  const auto at = heights.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(heights.size() - 1));
  std::nth_element(heights.begin(), at, heights.end());
  return *at;
}

}  // namespace

ObjectRegion findObjectRegion(const std::vector<ObjectView>& views, const RecordingParameters& parameters) {
  const int half = static_cast<int>(std::ceil(parameters.max_radius / kBoardCell));
  const int needed = std::max(1, static_cast<int>(kShareOfViews * static_cast<double>(views.size())));
  const cv::Mat occupied = countOccupied(views, parameters, half) >= needed;
  cv::Mat joined, labels, stats, centroids;
  cv::dilate(occupied, joined, cv::Mat());
  const int count = cv::connectedComponentsWithStats(joined, labels, stats, centroids);
  int best = 0;
  double nearest = 1e9;
  for (int i = 1; i < count; ++i) {
    const double distance = cv::norm(centroids.row(i) - cv::Mat(cv::Vec2d(half, half)).t());
    if (stats.at<int>(i, cv::CC_STAT_AREA) < kMin || distance > nearest) continue;
    nearest = distance;
    best = i;
  }
  if (best == 0) throw std::runtime_error("nothing stands above the board, or the plane z = 0 where there is none");
  std::vector<cv::Point> cells;
  cv::findNonZero((labels == best) & occupied, cells);
  cv::Point2f centre;
  float radius = 0.0f;
  cv::minEnclosingCircle(cells, centre, radius);
  ObjectRegion region;
  region.axis = {(centre.x - static_cast<float>(half)) * kBoardCell,
                 (centre.y - static_cast<float>(half)) * kBoardCell};
  region.margin = kMargin;
  region.radius = radius * kBoardCell + kMargin;
  region.bottom = static_cast<float>(parameters.plane_margin);
  region.top = static_cast<float>(parameters.max_height);
  if (region.axis.norm() + radius * kBoardCell > parameters.max_radius)
    throw std::runtime_error("what stands on the board reaches beyond " + std::to_string(parameters.max_radius) +
                             " m from its middle: the object is larger than the board, or something stands beside it, "
                             "or, without a board, the plane z = 0 is below what the object stands on");
  region.top = highestIn(views, region) + kMargin;
  return region;
}

cv::Mat maskOfRegion(const ObjectView& view, const ObjectRegion& region) {
  cv::Mat mask(view.depth.size(), CV_8UC1, cv::Scalar(0));
  for (int v = 0; v < mask.rows; ++v)
    for (int u = 0; u < mask.cols; ++u)
      if (view.depth.at<float>(v, u) > 0.0f && region.contains(view.worldPoint(u, v))) mask.at<uchar>(v, u) = 255;
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::Mat());
  return mask;
}

}  // namespace recognition
