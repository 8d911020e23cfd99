#include "training/cloud_colors.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr float kMinColorCosine = 0.35f;            // of the slant; steeper surface is blurred
constexpr float kSameSurface = 0.012f;              // metres between the point and what the view measures there
constexpr int kRim = 2;                             // depth pixels at the mask's rim, which mix object and background
constexpr float kClipped = 250.0f;                  // of a channel; beyond, only how bright it is at least is known
constexpr float kClippedWeight = 0.02f;             // beside views that are not clipped there
constexpr float kFirst = 0.25f, kLast = 0.75f;      // of the views by brightness, those that count
constexpr float kBoardSteps = 120.0f;               // along a board's side, between places where paper is looked for
constexpr float kOnBoard = 0.01f;                   // metres between the board and what the view measures there
constexpr size_t kMinOnBoard = 200;                 // places
constexpr double kPaperFrom = 0.7, kPaperTo = 0.9;  // of them by brightness, the paper: neither ink nor glare

bool isClipped(const cv::Vec3f& rgb) { return std::max({rgb[0], rgb[1], rgb[2]}) >= kClipped; }

float brightnessOf(const cv::Vec3f& rgb) { return 0.299f * rgb[0] + 0.587f * rgb[1] + 0.114f * rgb[2]; }

struct Look {
  cv::Vec3f rgb;
  float brightness = 0.0f;
  float weight = 0.0f;  // 0: the view does not see the point
};

// Where a view shows a point (world frame) in colour; nothing if it measures something else there, or `mask` (depth
// resolution) is 0.
std::optional<cv::Point> findColor(const ObjectView& view, const Eigen::Vector3f& point, float tolerance,
                                   const cv::Mat& mask = {}) {
  const auto seen = view.find(point);
  if (!seen || std::abs(seen->gap) > tolerance) return std::nullopt;
  if (!mask.empty() && mask.at<uchar>(seen->pixel) == 0) return std::nullopt;
  const Eigen::Vector2d in_color = view.color_camera.project(seen->position);
  const cv::Point pixel(cvRound(in_color.x()), cvRound(in_color.y()));
  if (!cv::Rect({}, view.color.size()).contains(pixel)) return std::nullopt;
  return pixel;
}

std::vector<Look> lookAt(const std::vector<SurfacePoint>& cloud, const ObjectView& view, float spacing) {
  cv::Mat inner, blurred;
  cv::erode(view.mask, inner, cv::Mat(), cv::Point(-1, -1), kRim, cv::BORDER_CONSTANT, cv::Scalar(0));
  const Eigen::Vector3f eye = view.cameraPlace();
  const int width = std::max(1, cvRound(spacing * view.color_camera.fx / static_cast<double>(eye.norm())));
  cv::blur(view.color, blurred, cv::Size(width, width));
  const cv::Vec3f light(kPaper / view.paper[0], kPaper / view.paper[1], kPaper / view.paper[2]);
  std::vector<Look> looks(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    const float cosine = cloud[i].normal.dot((eye - cloud[i].position).normalized());
    if (cosine < kMinColorCosine) continue;
    const auto pixel = findColor(view, cloud[i].position, kSameSurface, inner);
    if (!pixel) continue;
    const cv::Vec3f rgb = blurred.at<cv::Vec3b>(*pixel);
    const cv::Vec3f lit = rgb.mul(light);
    looks[i] = {lit, brightnessOf(lit), cosine * cosine * (isClipped(rgb) ? kClippedWeight : 1.0f)};
  }
  return looks;
}

// Those between two shares of the weight, by brightness, averaged.
cv::Vec3f middleOf(std::vector<Look>& looks) {
  std::sort(looks.begin(), looks.end(), [](const Look& a, const Look& b) { return a.brightness < b.brightness; });
  float weight = 0.0f;
  for (const Look& look : looks) weight += look.weight;
  cv::Vec3f sum(0.0f, 0.0f, 0.0f);
  float passed = 0.0f;
  for (const Look& look : looks) {
    const float from = std::max(passed, kFirst * weight), to = std::min(passed + look.weight, kLast * weight);
    if (to > from) sum += (to - from) * look.rgb;
    passed += look.weight;
  }
  return sum / ((kLast - kFirst) * weight);
}

}  // namespace

cv::Vec3f colorOfPaper(const FiducialBoard& board, const ObjectView& view) {
  std::vector<cv::Vec3f> seen;
  const Eigen::Vector2f size = board.size().cast<float>(), step = size / kBoardSteps;
  for (float x = -0.5f * size.x(); x < 0.5f * size.x(); x += step.x())
    for (float y = -0.5f * size.y(); y < 0.5f * size.y(); y += step.y())
      if (const auto pixel = findColor(view, {x, y, 0.0f}, kOnBoard)) seen.push_back(view.color.at<cv::Vec3b>(*pixel));
  if (seen.size() < kMinOnBoard) return cv::Vec3f::all(kPaper);
  std::sort(seen.begin(), seen.end(),
            [](const cv::Vec3f& a, const cv::Vec3f& b) { return brightnessOf(a) < brightnessOf(b); });
  cv::Vec3f sum(1.0f, 1.0f, 1.0f);
  const auto count = static_cast<double>(seen.size());
  const auto first = static_cast<size_t>(kPaperFrom * count), last = static_cast<size_t>(kPaperTo * count);
  for (size_t i = first; i < last; ++i) sum += seen[i];
  return sum / static_cast<float>(last - first);
}

double overexposedShare(const ObjectView& view) {
  const int k = view.color_per_depth;
  int pixels = 0, clipped = 0;
  for (int v = 0; v < view.mask.rows; ++v)
    for (int u = 0; u < view.mask.cols; ++u) {
      const cv::Point color(u * k + k / 2, v * k + k / 2);
      if (view.mask.at<uchar>(v, u) == 0 || !cv::Rect({}, view.color.size()).contains(color)) continue;
      ++pixels;
      clipped += isClipped(view.color.at<cv::Vec3b>(color));
    }
  return pixels > 0 ? static_cast<double>(clipped) / pixels : 0.0;
}

void takeColors(const std::vector<ObjectView>& views, float spacing, std::vector<SurfacePoint>& cloud) {
  std::vector<std::vector<Look>> looks(views.size());
  cv::parallel_for_(cv::Range(0, static_cast<int>(views.size())), [&](const cv::Range& range) {
    for (auto i = static_cast<size_t>(range.start); i < static_cast<size_t>(range.end); ++i)
      looks[i] = lookAt(cloud, views[i], spacing);
  });
  for (size_t i = 0; i < cloud.size(); ++i) {
    std::vector<Look> seen;
    for (const std::vector<Look>& of_view : looks)
      if (of_view[i].weight > 0.0f) seen.push_back(of_view[i]);
    if (seen.empty()) continue;
    const cv::Vec3f rgb = middleOf(seen);
    for (int channel = 0; channel < 3; ++channel) cloud[i].rgb[channel] = cv::saturate_cast<uchar>(rgb[channel]);
  }
}

}  // namespace recognition
