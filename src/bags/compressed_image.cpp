#include "bags/compressed_image.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "ros/image_conversions.h"

namespace recognition {
namespace {

constexpr size_t kDepthHeader = 12;             // bytes: the kind, and the two parameters of quantised float depth
constexpr std::uint64_t kMaxPixels = 1u << 24;  // of RVL, which packs an empty image into nearly nothing

[[noreturn]] void refuse(const sensor_msgs::CompressedImage& message, const std::string& what) {
  throw std::invalid_argument("compressed image of format '" + message.format + "' " + what);
}

bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

cv::Mat decode(const sensor_msgs::CompressedImage& message, size_t first) {
  cv::Mat image;
  if (first < message.data.size()) {
    const cv::Mat bytes(1, static_cast<int>(message.data.size() - first), CV_8UC1,
                        const_cast<std::uint8_t*>(message.data.data() + first));
    try {
      image = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
    }
  }
  if (image.empty()) refuse(message, "is damaged: " + std::to_string(message.data.size()) + " bytes that are no image");
  return image;
}

/// Depth packed by "RVL" (Wilson 2017): runs of zeros and differences, in words of three bits and one that goes on.
class Rvl {
 public:
  Rvl(const std::uint8_t* begin, const std::uint8_t* end) : at_(begin), end_(end) {}

  bool decode(cv::Mat& depth) {
    const auto count = static_cast<std::int64_t>(depth.total());
    auto* const pixels = depth.ptr<std::uint16_t>();
    std::int64_t done = 0;
    int last = 0;
    while (done < count) {
      const std::int64_t zeros = number();
      done += zeros;
      const std::int64_t values = number();
      if (!good_ || zeros > count || values > count || done + values > count || zeros + values == 0) return false;
      for (std::int64_t i = 0; i < values; ++i) {
        const std::int64_t packed = number();
        last += static_cast<int>((packed >> 1) ^ -(packed & 1));
        pixels[done++] = static_cast<std::uint16_t>(last);
      }
    }
    return good_;
  }

 private:
  std::int64_t number() {
    std::int64_t value = 0;
    for (int shift = 0; shift <= 30; shift += 3) {
      const int nibble = next();
      value |= static_cast<std::int64_t>(nibble & 7) << shift;
      if ((nibble & 8) == 0) return value;
    }
    good_ = false;
    return 0;
  }

  int next() {
    if (left_ == 0) {
      if (end_ - at_ < 4) {
        good_ = false;
        return 0;
      }
      std::memcpy(&word_, at_, 4);
      at_ += 4;
      left_ = 8;
    }
    const int nibble = static_cast<int>(word_ >> 28);
    word_ <<= 4;
    --left_;
    return nibble;
  }

  const std::uint8_t *at_, *end_;
  std::uint32_t word_ = 0;
  int left_ = 0;  // nibbles in the word
  bool good_ = true;
};

cv::Mat decodeRvl(const sensor_msgs::CompressedImage& message) {
  std::uint32_t size[2] = {};
  if (message.data.size() < kDepthHeader + sizeof size) refuse(message, "is too short");
  std::memcpy(size, message.data.data() + kDepthHeader, sizeof size);
  const std::uint64_t pixels = std::uint64_t{size[0]} * size[1];
  if (pixels == 0 || pixels > kMaxPixels) refuse(message, "has an implausible size");
  cv::Mat depth(static_cast<int>(size[1]), static_cast<int>(size[0]), CV_16UC1, cv::Scalar(0));
  const std::uint8_t* const begin = message.data.data() + kDepthHeader + sizeof size;
  if (!Rvl(begin, message.data.data() + message.data.size()).decode(depth)) refuse(message, "is damaged");
  return depth;
}

/// Float depth as its inverse, in steps.
cv::Mat unquantised(const cv::Mat& steps, const sensor_msgs::CompressedImage& message) {
  float parameters[2];
  std::memcpy(parameters, message.data.data() + 4, sizeof parameters);
  cv::Mat depth(steps.size(), CV_32FC1);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const std::uint16_t step = steps.at<std::uint16_t>(v, u);
      depth.at<float>(v, u) = step == 0 ? std::numeric_limits<float>::quiet_NaN()
                                        : parameters[0] / (static_cast<float>(step) - parameters[1]);
    }
  return depth;
}

}  // namespace

sensor_msgs::ImagePtr colorFromCompressed(const sensor_msgs::CompressedImage& message) {
  if (contains(message.format, "compressedDepth")) refuse(message, "is depth, not colour");
  cv::Mat image = decode(message, 0);
  if (image.depth() == CV_16U && image.channels() > 1) image.convertTo(image, CV_8U, 1.0 / 257.0);
  if (image.channels() == 4) cv::cvtColor(image, image, cv::COLOR_BGRA2BGR);
  if (image.depth() != CV_8U && image.type() != CV_16UC1) refuse(message, "is no colour image of 8 or 16 bits");
  const std::string before = message.format.substr(0, message.format.find(';'));
  const sensor_msgs::ImagePtr result = imageMessage(image, message.header);
  if (image.type() == CV_16UC1) result->encoding = "mono16";
  if (image.channels() == 1 && before.rfind("bayer_", 0) == 0) result->encoding = before;
  if (image.channels() == 3 && contains(message.format, "compressed rgb8")) result->encoding = "rgb8";
  return result;
}

sensor_msgs::ImagePtr depthFromCompressed(const sensor_msgs::CompressedImage& message) {
  const bool is_float = message.format.rfind("32FC1", 0) == 0;
  if (!contains(message.format, "compressedDepth")) {
    const cv::Mat image = decode(message, 0);  // as a PNG of 16 bits, which loses nothing
    if (image.type() != CV_16UC1) refuse(message, "is no depth image of 16 bits");
    return imageMessage(image, message.header);
  }
  if (message.data.size() <= kDepthHeader) refuse(message, "is too short");
  const cv::Mat steps = contains(message.format, "rvl") ? decodeRvl(message) : decode(message, kDepthHeader);
  if (steps.type() != CV_16UC1) refuse(message, "is no depth image of 16 bits");
  return imageMessage(is_float ? unquantised(steps, message) : steps, message.header);
}

}  // namespace recognition
