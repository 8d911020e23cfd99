#include "meshes/texture_pyramid.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr int kMinLevel = 4;  // texels

float wrapped(float x) { return x - std::floor(x); }

// 1 where a triangle lies on the texture. Triangles that cross the border of a repeated texture count as covering all
// of it.
cv::Mat coverage(const TexturedMesh& mesh) {
  const cv::Size size = mesh.texture.size();
  cv::Mat mask(size, CV_8UC1, cv::Scalar(0));
  for (const auto& triangle : mesh.triangles) {
    cv::Point corners[3];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2f& uv = mesh.texture_coordinates[triangle[static_cast<size_t>(k)]];
      if (uv.minCoeff() < 0.0f || uv.maxCoeff() > 1.0f) return cv::Mat(size, CV_32FC1, cv::Scalar(1.0));
      corners[k] = {cvRound(uv.x() * static_cast<float>(size.width) - 0.5f),
                    cvRound((1.0f - uv.y()) * static_cast<float>(size.height) - 0.5f)};
    }
    cv::fillConvexPoly(mask, corners, 3, cv::Scalar(1));
  }
  if (cv::countNonZero(mask) == 0) mask.setTo(1);
  cv::Mat weights;
  mask.convertTo(weights, CV_32F);
  return weights;
}

// Mean of the covered ones among the texels that fall together.
void halve(const cv::Mat& color, const cv::Mat& weight, cv::Mat& half_color, cv::Mat& half_weight) {
  const cv::Size size(std::max(1, color.cols / 2), std::max(1, color.rows / 2));
  cv::Mat weight3, weighted;
  cv::merge(std::vector<cv::Mat>(3, weight), weight3);
  cv::resize(color.mul(weight3), weighted, size, 0, 0, cv::INTER_AREA);
  cv::resize(weight, half_weight, size, 0, 0, cv::INTER_AREA);
  cv::merge(std::vector<cv::Mat>(3, cv::max(half_weight, 1e-6)), weight3);
  half_color = weighted / weight3;
  cv::threshold(half_weight, half_weight, 1e-6, 1.0, cv::THRESH_BINARY);
}

}  // namespace

TexturePyramid::TexturePyramid(const TexturedMesh& mesh) {
  std::vector<cv::Mat> colors(1), weights(1, coverage(mesh));
  mesh.texture.convertTo(colors[0], CV_32F);
  while (std::min(colors.back().cols, colors.back().rows) > kMinLevel) {
    cv::Mat color, weight;
    halve(colors.back(), weights.back(), color, weight);
    colors.push_back(color);
    weights.push_back(weight);
  }
  levels_.resize(colors.size());
  for (size_t level = colors.size(); level-- > 0;) {
    if (level + 1 < colors.size()) {  // holes take the colour of the coarser level
      cv::Mat coarse;
      cv::resize(colors[level + 1], coarse, colors[level].size(), 0, 0, cv::INTER_LINEAR);
      coarse.copyTo(colors[level], weights[level] == 0.0);
    }
    colors[level].convertTo(levels_[level], CV_8U);
  }
}

Eigen::Vector3f TexturePyramid::sampleLevel(int level, const Eigen::Vector2f& coordinate) const {
  const cv::Mat& image = levels_[static_cast<size_t>(level)];
  const float x = wrapped(coordinate.x()) * static_cast<float>(image.cols) - 0.5f;
  const float y = (1.0f - wrapped(coordinate.y())) * static_cast<float>(image.rows) - 0.5f;
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const float wx = x - static_cast<float>(x0);
  const float wy = y - static_cast<float>(y0);
  const auto texel = [&image](int u, int v) {
    const auto& c = image.at<cv::Vec3b>(std::clamp(v, 0, image.rows - 1), std::clamp(u, 0, image.cols - 1));
    return Eigen::Vector3f(c[0], c[1], c[2]);
  };
  return (1.0f - wy) * ((1.0f - wx) * texel(x0, y0) + wx * texel(x0 + 1, y0)) +
         wy * ((1.0f - wx) * texel(x0, y0 + 1) + wx * texel(x0 + 1, y0 + 1));
}

Eigen::Vector3f TexturePyramid::sample(const Eigen::Vector2f& coordinate, float footprint) const {
  const float last = static_cast<float>(levels_.size() - 1);
  const float level = std::clamp(std::log2(std::max(footprint, 1.0f)), 0.0f, last);
  const int fine = static_cast<int>(level);
  const float weight = level - static_cast<float>(fine);
  const Eigen::Vector3f color = sampleLevel(fine, coordinate);
  return weight > 0.0f ? Eigen::Vector3f((1.0f - weight) * color + weight * sampleLevel(fine + 1, coordinate)) : color;
}

}  // namespace recognition
