#include "alignment/local_correlation.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/simd.h"

namespace recognition {
namespace {

constexpr float kSceneShare = 0.5f;  // of the scene's contrast: highlights and shadows are no texture

cv::Mat windowSum(const cv::Mat& image, int radius) {
  cv::Mat sum;
  const int size = 2 * radius + 1;
  cv::boxFilter(image, sum, CV_32F, {size, size}, {-1, -1}, false, cv::BORDER_CONSTANT);
  return sum;
}

/// A row of sums over the windows, and what comes of it.
struct SumRow {
  const float *n, *m, *s, *mm, *ss, *ms;
};

RGBD_SIMD_CLONES void correlateRow(const SumRow& sums, const float* mask, float floor, int count,
                                   float* __restrict correlation, float* __restrict contrast) {
  const SumRow r = sums;
  for (int u = 0; u < count; ++u) {
    const float inverse = 1.0f / std::max(1.0f, r.n[u]);
    const float mean_m = r.m[u] * inverse, mean_s = r.s[u] * inverse;
    const float var_m = std::max(0.0f, r.mm[u] * inverse - mean_m * mean_m);
    const float var_s = std::max(0.0f, r.ss[u] * inverse - mean_s * mean_s);
    const float covariance = r.ms[u] * inverse - mean_m * mean_s;
    const float value = covariance / std::sqrt((var_m + floor) * (var_s + floor));
    const float there = var_m + kSceneShare * var_s;
    correlation[u] = mask[u] * std::min(1.0f, std::max(-1.0f, value));
    contrast[u] = mask[u] * there / (there + 2.0f * floor);
  }
}

}  // namespace

LocalCorrelation correlateLocally(const cv::Mat& model, const cv::Mat& scene, const cv::Mat& mask, int radius,
                                  float noise) {
  const cv::Mat m = model.mul(mask), s = scene.mul(mask);
  const cv::Mat n = windowSum(mask, radius), sum_m = windowSum(m, radius), sum_s = windowSum(s, radius);
  const cv::Mat sum_mm = windowSum(m.mul(m), radius), sum_ss = windowSum(s.mul(s), radius),
                sum_ms = windowSum(m.mul(s), radius);
  LocalCorrelation out{cv::Mat(mask.size(), CV_32FC1), cv::Mat(mask.size(), CV_32FC1)};
  for (int v = 0; v < mask.rows; ++v) {
    const auto row = [v](const cv::Mat& image) { return image.ptr<float>(v); };
    correlateRow({row(n), row(sum_m), row(sum_s), row(sum_mm), row(sum_ss), row(sum_ms)}, row(mask), noise * noise,
                 mask.cols, out.correlation.ptr<float>(v), out.contrast.ptr<float>(v));
  }
  return out;
}

}  // namespace recognition
