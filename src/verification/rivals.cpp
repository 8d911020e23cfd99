#include "verification/rivals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "verification/evidence.h"

namespace recognition {
namespace {

constexpr int kMinPixels = 20;          // on which the two differ; fewer are chance
constexpr double kDifferent = 15.0;     // CIELAB
constexpr double kMaxDistance = 50.0;   // CIELAB: a highlight counts no more than that
constexpr double kAlignmentCap = 30.0;  // likewise, as most of the pixels agree
constexpr int kMaxShift = 2;            // pixels, of a pose that is slightly off
constexpr int kSmoothing = 3;           // pixels: side of the window, whose pixels then say the same

double distance(const cv::Vec3f& a, const cv::Vec3f& b) { return cv::norm(a - b); }

/// A hypothesis's model as lit, over its box; `mask` is 255 where its depth agrees with the frame.
struct LitSurface {
  cv::Rect box;
  cv::Mat color, mask;
  cv::Point shift;  // from the model's pixels to those of the frame that suit best

  LitSurface(const TestedHypothesis& tested, const PreparedModels& models, const SceneView& scene, const cv::Mat& seen)
      : box(tested.reprojected.box) {
    const PosedModel posed(models.at(tested.verified.hypothesis.object), tested.reprojected, tested.pixels.state,
                           scene);
    mask = posed.inside & (posed.state == static_cast<int>(PixelState::kConsistent));
    color = smoothed(lightModel(posed, fitIllumination(posed)).color, mask);
    shift = bestShift(seen);
  }

  bool covers(const cv::Point& pixel) const { return mask.at<std::uint8_t>(pixel - box.tl()) != 0; }
  const cv::Vec3f& at(const cv::Point& pixel) const { return color.at<cv::Vec3f>(pixel - box.tl()); }
  double distanceTo(const cv::Mat& seen, const cv::Point& pixel) const {
    const cv::Point there(std::clamp(pixel.x + shift.x, 0, seen.cols - 1),
                          std::clamp(pixel.y + shift.y, 0, seen.rows - 1));
    return std::min(kMaxDistance, distance(at(pixel), seen.at<cv::Vec3f>(there)));
  }

 private:
  /// The mean over the window of the pixels in `mask`.
  static cv::Mat smoothed(const cv::Mat& color, const cv::Mat& mask) {
    cv::Mat weights, masked = cv::Mat::zeros(color.size(), CV_32FC3), mean;
    color.copyTo(masked, mask);
    mask.convertTo(weights, CV_32F, 1.0 / 255);
    cv::blur(masked, masked, {kSmoothing, kSmoothing});
    cv::blur(weights, weights, {kSmoothing, kSmoothing});
    cv::cvtColor(cv::max(weights, 1e-3), weights, cv::COLOR_GRAY2BGR);
    cv::divide(masked, weights, mean);
    return mean;
  }

  cv::Point bestShift(const cv::Mat& seen) const {
    const cv::Rect image(0, 0, seen.cols, seen.rows);
    cv::Point best_shift;
    double best = std::numeric_limits<double>::max();
    for (int y = -kMaxShift; y <= kMaxShift; ++y)
      for (int x = -kMaxShift; x <= kMaxShift; ++x) {
        double sum = 0.0;
        int count = 0;
        for (int v = 0; v < box.height; ++v)
          for (int u = 0; u < box.width; ++u) {
            const cv::Point there = box.tl() + cv::Point(u + x, v + y);
            if (!mask.at<std::uint8_t>(v, u) || !image.contains(there)) continue;
            sum += std::min(kAlignmentCap, distance(color.at<cv::Vec3f>(v, u), seen.at<cv::Vec3f>(there)));
            ++count;
          }
        if (count == 0 || sum >= best * count) continue;
        best = sum / count;
        best_shift = {x, y};
      }
    return best_shift;
  }
};

}  // namespace

double colorPreference(const TestedHypothesis& a, const TestedHypothesis& b, const PreparedModels& models,
                       const SceneView& scene) {
  cv::Mat seen;
  cv::blur(scene.lab, seen, {kSmoothing, kSmoothing});
  const LitSurface first(a, models, scene, seen), second(b, models, scene, seen);
  const cv::Rect common = first.box & second.box;
  double sum = 0.0, squares = 0.0;
  int pixels = 0;
  for (int v = common.y; v < common.y + common.height; ++v)
    for (int u = common.x; u < common.x + common.width; ++u) {
      const cv::Point pixel(u, v);
      if (!first.covers(pixel) || !second.covers(pixel)) continue;
      if (distance(first.at(pixel), second.at(pixel)) < kDifferent) continue;
      const double preference = second.distanceTo(seen, pixel) - first.distanceTo(seen, pixel);
      sum += preference;
      squares += preference * preference;
      ++pixels;
    }
  if (pixels < kMinPixels) return 0.0;
  const double mean = sum / pixels, variance = std::max(1e-6, squares / pixels - mean * mean);
  return mean / std::sqrt(variance * kSmoothing * kSmoothing / pixels);
}

}  // namespace recognition
