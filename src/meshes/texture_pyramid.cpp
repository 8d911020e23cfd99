#include "meshes/texture_pyramid.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr int kMinLevel = 4;  // texels

float wrapped(float x) { return x - std::floor(x); }

// Not 0 where a triangle lies on the texture. Triangles that cross the border of a repeated texture count as covering
// all of it.
cv::Mat coverage(const TexturedMesh& mesh) {
  const cv::Size size = mesh.texture.size();
  cv::Mat mask(size, CV_8UC1, cv::Scalar(0));
  for (const auto& triangle : mesh.triangles) {
    cv::Point corners[3];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2f& uv = mesh.texture_coordinates[triangle[static_cast<size_t>(k)]];
      if (uv.minCoeff() < 0.0f || uv.maxCoeff() > 1.0f) return cv::Mat(size, CV_8UC1, cv::Scalar(1));
      corners[k] = {cvRound(uv.x() * static_cast<float>(size.width) - 0.5f),
                    cvRound((1.0f - uv.y()) * static_cast<float>(size.height) - 0.5f)};
    }
    cv::fillConvexPoly(mask, corners, 3, cv::Scalar(1));
  }
  if (cv::countNonZero(mask) == 0) mask.setTo(1);
  return mask;
}

// Which texels of a line of `from` fall onto texel `i` of one of `to`, and with how much of their width.
struct Share {
  int first = 0, count = 0;
  float weights[4];

  Share(int i, int from, int to) {
    const float scale = static_cast<float>(from) / static_cast<float>(to);
    const float begin = static_cast<float>(i) * scale, end = begin + scale;
    first = static_cast<int>(begin);
    for (int at = first; at < from && static_cast<float>(at) < end - 1e-4f && count < 4; ++at, ++count)
      weights[count] = std::min(end, static_cast<float>(at + 1)) - std::max(begin, static_cast<float>(at));
  }
};

// Mean of the covered ones among the texels that fall together. Bytes throughout: large textures take much memory.
void halve(const cv::Mat& color, const cv::Mat& covered, cv::Mat& half_color, cv::Mat& half_covered) {
  const cv::Size size(std::max(1, color.cols / 2), std::max(1, color.rows / 2));
  half_color.create(size, CV_8UC3);
  half_covered.create(size, CV_8UC1);
  std::vector<Share> columns;
  for (int x = 0; x < size.width; ++x) columns.emplace_back(x, color.cols, size.width);
  cv::parallel_for_(cv::Range(0, size.height), [&](const cv::Range& range) {
    for (int y = range.start; y < range.end; ++y) {
      const Share rows(y, color.rows, size.height);
      for (int x = 0; x < size.width; ++x) {
        const Share& of_row = columns[static_cast<size_t>(x)];
        cv::Vec3f sum(0.0f, 0.0f, 0.0f);
        float weight = 0.0f;
        for (int r = 0; r < rows.count; ++r)
          for (int c = 0; c < of_row.count; ++c) {
            if (covered.at<uchar>(rows.first + r, of_row.first + c) == 0) continue;
            const float share = rows.weights[r] * of_row.weights[c];
            sum += share * cv::Vec3f(color.at<cv::Vec3b>(rows.first + r, of_row.first + c));
            weight += share;
          }
        half_covered.at<uchar>(y, x) = weight > 0.0f;
        half_color.at<cv::Vec3b>(y, x) = weight > 0.0f ? cv::Vec3b(sum / weight) : cv::Vec3b(0, 0, 0);
      }
    }
  });
}

}  // namespace

TexturePyramid::TexturePyramid(const TexturedMesh& mesh) {
  std::vector<cv::Mat> covered(1, coverage(mesh));
  levels_.push_back(mesh.texture.clone());
  while (std::min(levels_.back().cols, levels_.back().rows) > kMinLevel) {
    cv::Mat color, mask;
    halve(levels_.back(), covered.back(), color, mask);
    levels_.push_back(color);
    covered.push_back(mask);
  }
  for (size_t level = levels_.size() - 1; level-- > 0;) {  // holes take the colour of the coarser level
    cv::Mat coarse;
    cv::resize(levels_[level + 1], coarse, levels_[level].size(), 0, 0, cv::INTER_LINEAR);
    coarse.copyTo(levels_[level], covered[level] == 0);
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
