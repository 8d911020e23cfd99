#include "alignment/local_correlation.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr float kSceneShare = 0.5f;  // of the scene's contrast: highlights and shadows are no texture

cv::Mat windowSum(const cv::Mat& image, int radius) {
  cv::Mat sum;
  const int size = 2 * radius + 1;
  cv::boxFilter(image, sum, CV_32F, {size, size}, {-1, -1}, false, cv::BORDER_CONSTANT);
  return sum;
}

}  // namespace

LocalCorrelation correlateLocally(const cv::Mat& model, const cv::Mat& scene, const cv::Mat& mask, int radius,
                                  float noise) {
  const cv::Mat m = model.mul(mask), s = scene.mul(mask);
  const cv::Mat n = windowSum(mask, radius), sum_m = windowSum(m, radius), sum_s = windowSum(s, radius);
  const cv::Mat sum_mm = windowSum(m.mul(m), radius), sum_ss = windowSum(s.mul(s), radius),
                sum_ms = windowSum(m.mul(s), radius);
  LocalCorrelation out{cv::Mat(mask.size(), CV_32FC1, cv::Scalar(0)), cv::Mat(mask.size(), CV_32FC1, cv::Scalar(0))};
  const float floor = noise * noise;
  for (int v = 0; v < mask.rows; ++v) {
    for (int u = 0; u < mask.cols; ++u) {
      if (mask.at<float>(v, u) == 0.0f) continue;
      const float inverse = 1.0f / n.at<float>(v, u);
      const float mean_m = sum_m.at<float>(v, u) * inverse, mean_s = sum_s.at<float>(v, u) * inverse;
      const float var_m = std::max(0.0f, sum_mm.at<float>(v, u) * inverse - mean_m * mean_m);
      const float var_s = std::max(0.0f, sum_ss.at<float>(v, u) * inverse - mean_s * mean_s);
      const float cov = sum_ms.at<float>(v, u) * inverse - mean_m * mean_s;
      out.correlation.at<float>(v, u) = std::clamp(cov / std::sqrt((var_m + floor) * (var_s + floor)), -1.0f, 1.0f);
      const float contrast = var_m + kSceneShare * var_s;
      out.contrast.at<float>(v, u) = contrast / (contrast + 2.0f * floor);
    }
  }
  return out;
}

}  // namespace recognition
