// Images, clouds and camera infos as another node may send them.
#include <iterator>

#include <boost/make_shared.hpp>

#include "bags/compressed_image.h"
#include "fuzz/fuzz.h"
#include "ros/image_conversions.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

/// Small numbers, and some huge ones, from bytes.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, size_t size) : data_(data), end_(data + size) {}
  std::uint32_t next() { return data_ < end_ ? *data_++ : 0u; }
  std::uint32_t size() {
    const std::uint32_t value = next();
    return value == 255 ? 0xffffffffu - next() : value;
  }
  std::vector<std::uint8_t> rest() const { return {data_, end_}; }

 private:
  const std::uint8_t *data_, *end_;
};

sensor_msgs::ImagePtr image(Bytes& bytes) {
  static const char* const kEncodings[] = {"rgb8",   "bgra8",       "16UC1", "32FC1",  "mono8",        "32SC1",
                                           "yuv422", "bayer_rggb8", "rgb16", "mono16", "bayer_gbrg16", ""};
  const auto message = boost::make_shared<sensor_msgs::Image>();
  message->encoding = kEncodings[bytes.next() % std::size(kEncodings)];
  message->width = bytes.size(), message->height = bytes.size(), message->step = bytes.size();
  message->is_bigendian = static_cast<std::uint8_t>(bytes.next() % 8 == 0);
  message->data.resize(bytes.next() * 16, 7);
  return message;
}

sensor_msgs::PointCloud2 cloud(Bytes& bytes) {
  sensor_msgs::PointCloud2 message;
  message.width = bytes.size(), message.height = bytes.size();
  message.point_step = bytes.size(), message.row_step = bytes.size();
  message.fields.resize(1);
  message.fields[0].name = "z";
  message.fields[0].offset = bytes.size();
  message.fields[0].datatype = static_cast<std::uint8_t>(bytes.next() % 10);
  message.data = bytes.rest();
  return message;
}

}  // namespace
}  // namespace recognition

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  using namespace recognition;
  Bytes bytes(data, size);
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  info->P[0] = info->P[5] = bytes.next(), info->P[2] = bytes.next(), info->P[6] = bytes.next();
  info->width = bytes.size(), info->height = bytes.size();
  info->binning_x = bytes.size(), info->roi.width = bytes.size(), info->roi.height = bytes.next();
  const auto color = image(bytes), depth = image(bytes);
  mayRefuse([&] { depthInMetres(frameView({colorWithThreeChannels(color), depth, info}).depth); });
  info->K[0] = info->K[4] = bytes.next(), info->D.assign(bytes.next() % 15, 0.01 * bytes.next());
  mayRefuse([&] { undistortedFrame({colorWithThreeChannels(color), depth, info}); });
  static const char* const kFormats[] = {"16UC1; compressedDepth",      "32FC1; compressedDepth png",
                                         "16UC1; compressedDepth rvl",  "bgr8; jpeg compressed bgr8",
                                         "bayer_rggb8; png compressed", "png"};
  sensor_msgs::CompressedImage packed;
  packed.format = kFormats[bytes.next() % std::size(kFormats)];
  packed.data = bytes.rest();
  mayRefuse([&] { colorWithThreeChannels(colorFromCompressed(packed)); });
  mayRefuse([&] { depthFromCompressed(packed); });
  mayRefuse([&] { labelView(*depth); });
  mayRefuse([&] { maskView(*depth); });
  mayRefuse([&] { depthFromPoints(cloud(bytes)); });
  return 0;
}
