#include "rgbd_recognition/features/feature_types.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "core/simd.h"

namespace recognition {
namespace {

RGBD_SIMD_CLONES void quantizeRow(const float* from, int length, std::int8_t* to) {
  for (int k = 0; k < length; ++k) {
    const float limited = std::min(std::max(from[k] * kDescriptorScale, -127.0f), 127.0f);
    to[k] = static_cast<std::int8_t>(limited + (limited < 0.0f ? -0.5f : 0.5f));
  }
}

void normalizeRow(const std::int8_t* from, int length, float* to) {
  float sum = 0.0f;
  for (int k = 0; k < length; ++k) sum += static_cast<float>(from[k]) * static_cast<float>(from[k]);
  const float scale = sum > 0.0f ? 1.0f / std::sqrt(sum) : 0.0f;
  for (int k = 0; k < length; ++k) to[k] = scale * static_cast<float>(from[k]);
}

[[noreturn]] void refuse(const cv::Mat& descriptors) {
  throw std::invalid_argument("descriptors of OpenCV type " + std::to_string(descriptors.type()) +
                              " are neither floats nor 8-bit");
}

}  // namespace

const char* descriptorName(DescriptorType type) {
  switch (type) {
    case DescriptorType::kSurf128:
      return "surf128";
    case DescriptorType::kSurf64:
      return "surf64";
    case DescriptorType::kSift:
      return "sift";
  }
  return "";
}

DescriptorType descriptorFromName(const std::string& name) {
  for (const DescriptorType type : {DescriptorType::kSurf128, DescriptorType::kSurf64, DescriptorType::kSift})
    if (name == descriptorName(type)) return type;
  throw std::invalid_argument("descriptor type '" + name + "' is none of surf128, surf64, sift");
}

int descriptorLength(DescriptorType type) { return type == DescriptorType::kSurf64 ? 64 : 128; }

cv::Mat quantizedDescriptors(const cv::Mat& descriptors) {
  if (descriptors.empty() || descriptors.type() == CV_8SC1) return descriptors;
  if (descriptors.type() != CV_32FC1) refuse(descriptors);
  cv::Mat quantized(descriptors.size(), CV_8SC1);
  for (int i = 0; i < descriptors.rows; ++i)
    quantizeRow(descriptors.ptr<float>(i), descriptors.cols, quantized.ptr<std::int8_t>(i));
  return quantized;
}

cv::Mat unitDescriptors(const cv::Mat& descriptors) {
  if (descriptors.empty() || descriptors.type() == CV_32FC1) return descriptors;
  if (descriptors.type() != CV_8SC1) refuse(descriptors);
  cv::Mat units(descriptors.size(), CV_32FC1);
  for (int i = 0; i < descriptors.rows; ++i)
    normalizeRow(descriptors.ptr<std::int8_t>(i), descriptors.cols, units.ptr<float>(i));
  return units;
}

}  // namespace recognition
