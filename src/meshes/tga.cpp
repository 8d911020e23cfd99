#include <algorithm>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "meshes/files_beside.h"

namespace recognition {
namespace {

constexpr size_t kHeader = 18;  // bytes

/// Kinds of image data; those with run lengths have 8 more.
enum Kind { kPalette = 1, kTrueColor = 2, kGray = 3, kRunLengths = 8 };

class Tga {
 public:
  explicit Tga(const std::string& bytes) : bytes_(bytes) {}

  cv::Mat decode() {
    if (bytes_.size() < kHeader || !readHeader()) return {};
    at_ = kHeader + byte(0);
    palette_begin_ = at_;
    if (byte(1) == 1) at_ += static_cast<size_t>(word(5)) * entryBytes();
    cv::Mat image(height_, width_, CV_8UC3, cv::Scalar::all(0));
    if (!readPixels(image)) return {};
    const int flip = byte(17);
    if ((flip & 0x20) == 0) cv::flip(image, image, 0);  // rows from below
    if ((flip & 0x10) != 0) cv::flip(image, image, 1);
    return image;
  }

 private:
  int byte(size_t at) const { return at < bytes_.size() ? static_cast<unsigned char>(bytes_[at]) : 0; }
  int word(size_t at) const { return byte(at) | byte(at + 1) << 8; }
  size_t entryBytes() const { return static_cast<size_t>(byte(7) + 7) / 8; }

  bool readHeader() {
    packed_ = (byte(2) & kRunLengths) != 0;
    kind_ = byte(2) & ~kRunLengths;
    width_ = word(12), height_ = word(14);
    const int bits = byte(16);
    if (bits == 0) return false;
    size_ = static_cast<size_t>(bits + 7) / 8;
    const bool known = kind_ == kPalette     ? bits == 8 && byte(1) == 1 && (byte(7) == 24 || byte(7) == 32)
                       : kind_ == kTrueColor ? bits == 16 || bits == 15 || bits == 24 || bits == 32
                                             : kind_ == kGray && bits == 8;
    const size_t pixels = static_cast<size_t>(width_) * static_cast<size_t>(height_);
    const size_t max_pixels = packed_ ? bytes_.size() / (size_ + 1) * 128 : bytes_.size() / size_;
    return known && byte(1) <= 1 && pixels > 0 && pixels <= max_pixels;
  }

  bool readPixels(cv::Mat& image) {
    const std::int64_t count = static_cast<std::int64_t>(width_) * height_;
    if (!packed_ && bytes_.size() - std::min(at_, bytes_.size()) < static_cast<size_t>(count) * size_) return false;
    for (std::int64_t i = 0; i < count;) {
      int length = 1;
      bool repeats = false;
      if (packed_) {
        if (at_ >= bytes_.size()) return false;
        repeats = (byte(at_) & 0x80) != 0;
        length = (byte(at_++) & 0x7f) + 1;
      }
      for (; length > 0 && i < count; --length, ++i) {
        image.at<cv::Vec3b>(static_cast<int>(i / width_), static_cast<int>(i % width_)) = pixel(at_);
        if (!repeats || length == 1) at_ += size_;
      }
    }
    return at_ <= bytes_.size();
  }

  cv::Vec3b pixel(size_t at) const {
    if (kind_ == kGray) return cv::Vec3b::all(static_cast<uchar>(byte(at)));
    if (kind_ == kPalette) {
      const size_t entry = palette_begin_ + static_cast<size_t>(std::max(0, byte(at) - word(3))) * entryBytes();
      return color(entry);
    }
    if (size_ > 2) return color(at);
    const int bits = word(at);
    const auto channel = [&](int shift) { return static_cast<uchar>((bits >> shift & 31) * 255 / 31); };
    return {channel(0), channel(5), channel(10)};
  }

  cv::Vec3b color(size_t at) const {
    return {static_cast<uchar>(byte(at)), static_cast<uchar>(byte(at + 1)), static_cast<uchar>(byte(at + 2))};
  }

  const std::string& bytes_;
  int kind_ = 0, width_ = 0, height_ = 0;
  bool packed_ = false;
  size_t size_ = 0;  // of a pixel, bytes
  size_t at_ = 0, palette_begin_ = 0;
};

}  // namespace

cv::Mat decodeTga(const std::string& bytes) { return Tga(bytes).decode(); }

}  // namespace recognition
