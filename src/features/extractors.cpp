#include "features/extractors.h"

#include <stdexcept>
#include <tuple>

namespace recognition {

void requireImageAndMask(const cv::Mat& gray, const cv::Mat& mask) {
  if (gray.empty() || gray.type() != CV_8UC1) throw std::invalid_argument("features: image is empty or not 8-bit gray");
  if (mask.empty()) return;
  if (mask.type() != CV_8UC1 || mask.size() != gray.size())
    throw std::invalid_argument("features: mask is not 8-bit or " + std::to_string(mask.cols) + "x" +
                                std::to_string(mask.rows) + " for an image of " + std::to_string(gray.cols) + "x" +
                                std::to_string(gray.rows));
}

bool strongerKeypoint(const Keypoint& a, const Keypoint& b) {
  return std::make_tuple(-a.response, a.y, a.x, a.size, a.angle) <
         std::make_tuple(-b.response, b.y, b.x, b.size, b.angle);
}

}  // namespace recognition
