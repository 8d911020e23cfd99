#include "ros/image_conversions.h"

#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>

#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

#include "core/short_number.h"
#include "ros/frame_names.h"

namespace recognition {
namespace {

namespace enc = sensor_msgs::image_encodings;

constexpr std::uint32_t kMaxBinning = 64;

void require(bool good, const std::string& message) {
  if (!good) throw std::invalid_argument(message);
}

/// A header over the message's pixels; throws where encoding, byte order, step and data do not fit each other.
cv::Mat view(const sensor_msgs::Image& image, int type, const std::string& name) {
  const size_t pixel = CV_ELEM_SIZE(type), channel = CV_ELEM_SIZE1(type);
  const std::string size = std::to_string(image.width) + "x" + std::to_string(image.height);
  require(image.width > 0 && image.height > 0, name + " image has size " + size);
  require(image.width <= 16384 && image.height <= 16384, name + " image has the implausible size " + size);
  require(channel == 1 || !image.is_bigendian, name + " image is big-endian; only little-endian is read");
  require(image.step >= image.width * pixel && image.step % channel == 0,
          name + " image has step " + std::to_string(image.step) + ", a row of " + size + " " + image.encoding +
              " needs " + std::to_string(image.width * pixel));
  require(
      image.data.size() >= static_cast<size_t>(image.step) * (image.height - 1) + image.width * pixel,
      name + " image has " + std::to_string(image.data.size()) + " bytes, too few for " + size + " " + image.encoding);
  return {static_cast<int>(image.height), static_cast<int>(image.width), type,
          const_cast<std::uint8_t*>(image.data.data()), image.step};
}

const char* encodingOf(int type) {
  switch (type) {
    case CV_8UC1:
      return "mono8";
    case CV_8UC3:
      return "bgr8";
    case CV_16UC1:
      return "16UC1";
    case CV_32SC1:
      return "32SC1";
    case CV_32FC1:
      return "32FC1";
    default:
      throw std::invalid_argument("no encoding for matrix type " + std::to_string(type));
  }
}

/// Of the image, by binning and region of interest.
CameraModel cropped(const sensor_msgs::CameraInfo& info, CameraModel camera, const std::string& matrix) {
  require(std::isfinite(camera.fx) && std::isfinite(camera.fy) && std::isfinite(camera.cx) && std::isfinite(camera.cy),
          "camera info's " + matrix + " holds a number that is not finite");
  require(info.binning_x <= kMaxBinning && info.binning_y <= kMaxBinning,
          "camera info has binning " + std::to_string(info.binning_x) + "x" + std::to_string(info.binning_y));
  const int bin_x = std::max(1u, info.binning_x), bin_y = std::max(1u, info.binning_y);
  const bool whole = info.roi.width == 0 || info.roi.height == 0;
  camera.width = static_cast<int>(whole ? info.width : info.roi.width) / bin_x;
  camera.height = static_cast<int>(whole ? info.height : info.roi.height) / bin_y;
  camera.fx /= bin_x;
  camera.fy /= bin_y;
  // Integers are pixel centres: a binned pixel's centre lies in the middle of those it covers.
  camera.cx = (camera.cx - info.roi.x_offset + 0.5) / bin_x - 0.5;
  camera.cy = (camera.cy - info.roi.y_offset + 0.5) / bin_y - 0.5;
  return camera;
}

RgbdFrame viewWith(const FrameMessages& messages, const CameraModel& camera) {
  RgbdFrame frame;
  frame.color = colorView(*messages.color, &frame.color_order);
  frame.depth = depthView(*messages.depth);
  frame.color_camera = camera;
  const std::string color_id = plainFrame(messages.color->header.frame_id);
  const std::string depth_id = plainFrame(messages.depth->header.frame_id);
  require(color_id == depth_id, "depth image is in frame '" + depth_id + "', colour in '" + color_id +
                                    "': depth is not registered to colour");
  frame.validate();
  return frame;
}

/// How an encoding becomes BGR in 8 bits: OpenCV's type, and its conversion (-1: none).
struct ColorEncoding {
  int type;
  int conversion;
};

/// OpenCV names Bayer patterns by the second row's second and third pixel.
const std::map<std::string, ColorEncoding>& convertedEncodings() {
  static const std::map<std::string, ColorEncoding> encodings = {{enc::RGBA8, {CV_8UC4, cv::COLOR_RGBA2BGR}},
                                                                 {enc::BGRA8, {CV_8UC4, cv::COLOR_BGRA2BGR}},
                                                                 {enc::TYPE_8UC4, {CV_8UC4, cv::COLOR_BGRA2BGR}},
                                                                 {enc::MONO8, {CV_8UC1, cv::COLOR_GRAY2BGR}},
                                                                 {enc::TYPE_8UC1, {CV_8UC1, cv::COLOR_GRAY2BGR}},
                                                                 {enc::MONO16, {CV_16UC1, cv::COLOR_GRAY2BGR}},
                                                                 {enc::RGB16, {CV_16UC3, cv::COLOR_RGB2BGR}},
                                                                 {enc::BGR16, {CV_16UC3, -1}},
                                                                 {enc::RGBA16, {CV_16UC4, cv::COLOR_RGBA2BGR}},
                                                                 {enc::BGRA16, {CV_16UC4, cv::COLOR_BGRA2BGR}},
                                                                 {enc::BAYER_RGGB8, {CV_8UC1, cv::COLOR_BayerBG2BGR}},
                                                                 {enc::BAYER_BGGR8, {CV_8UC1, cv::COLOR_BayerRG2BGR}},
                                                                 {enc::BAYER_GBRG8, {CV_8UC1, cv::COLOR_BayerGR2BGR}},
                                                                 {enc::BAYER_GRBG8, {CV_8UC1, cv::COLOR_BayerGB2BGR}},
                                                                 {enc::BAYER_RGGB16, {CV_16UC1, cv::COLOR_BayerBG2BGR}},
                                                                 {enc::BAYER_BGGR16, {CV_16UC1, cv::COLOR_BayerRG2BGR}},
                                                                 {enc::BAYER_GBRG16, {CV_16UC1, cv::COLOR_BayerGR2BGR}},
                                                                 {enc::BAYER_GRBG16, {CV_16UC1, cv::COLOR_BayerGB2BGR}},
                                                                 {enc::YUV422, {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
                                                                 {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}}};
  return encodings;
}

}  // namespace

cv::Mat colorView(const sensor_msgs::Image& image, ColorOrder* order) {
  require(image.encoding == enc::RGB8 || image.encoding == enc::BGR8 || image.encoding == enc::TYPE_8UC3,
          "colour image has encoding '" + image.encoding +
              "'; rgb, bgr, rgba, bgra, mono, bayer (of 8 and 16 bits) and yuv422 are read");
  *order = image.encoding == enc::RGB8 ? ColorOrder::kRgb : ColorOrder::kBgr;
  return view(image, CV_8UC3, "colour");
}

cv::Mat depthView(const sensor_msgs::Image& image) {
  const bool millimetres = image.encoding == enc::TYPE_16UC1 || image.encoding == enc::MONO16;
  require(millimetres || image.encoding == enc::TYPE_32FC1,
          "depth image has encoding '" + image.encoding + "'; 16UC1 (mm), mono16 (mm) and 32FC1 (m) are read");
  return view(image, millimetres ? CV_16UC1 : CV_32FC1, "depth");
}

cv::Mat labelView(const sensor_msgs::Image& image) {
  require(image.encoding == enc::TYPE_32SC1, "label image has encoding '" + image.encoding + "', not 32SC1");
  return view(image, CV_32SC1, "label");
}

cv::Mat maskView(const sensor_msgs::Image& image) {
  require(image.encoding == enc::MONO8 || image.encoding == enc::TYPE_8UC1,
          "mask image has encoding '" + image.encoding + "', not mono8");
  return view(image, CV_8UC1, "mask");
}

CameraModel cameraFromInfo(const sensor_msgs::CameraInfo& info) {
  require(info.P[0] > 0.0 && info.P[5] > 0.0, "camera info has P[0] = " + shortNumber(info.P[0]) + " and P[5] = " +
                                                  shortNumber(info.P[5]) + ": the camera is not calibrated");
  return cropped(info, {0, 0, info.P[0], info.P[5], info.P[2], info.P[6]}, "P");
}

CameraModel rawCameraFromInfo(const sensor_msgs::CameraInfo& info) {
  require(info.K[0] > 0.0 && info.K[4] > 0.0, "camera info has K[0] = " + shortNumber(info.K[0]) + " and K[4] = " +
                                                  shortNumber(info.K[4]) + ": the camera is not calibrated");
  return cropped(info, {0, 0, info.K[0], info.K[4], info.K[2], info.K[5]}, "K");
}

Distortion distortionOf(const sensor_msgs::CameraInfo& info) { return {info.distortion_model, info.D}; }

sensor_msgs::CameraInfo cameraInfo(const CameraModel& camera, const std_msgs::Header& header) {
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

RgbdFrame frameView(const FrameMessages& messages) { return viewWith(messages, cameraFromInfo(*messages.camera_info)); }

RgbdFrame undistortedFrame(const FrameMessages& messages, bool depth_is_rectified) {
  const sensor_msgs::CameraInfo& info = *messages.camera_info;
  const CameraModel raw = rawCameraFromInfo(info);
  const CameraModel rectified = info.P[0] > 0.0 && info.P[5] > 0.0 ? cameraFromInfo(info) : raw;
  return undistorted(viewWith(messages, raw), distortionOf(info), rectified, depth_is_rectified);
}

bool isRectified(const std::string& topic) { return topic.find("image_rect") != std::string::npos; }

FrameMessages rectified(const FrameMessages& messages, const std::string& color_topic, const std::string& depth_topic) {
  if (isRectified(color_topic) || !distortionOf(*messages.camera_info).isThere()) return messages;
  FrameMessages three_channels = messages;
  three_channels.color = colorWithThreeChannels(messages.color);
  const RgbdFrame frame = undistortedFrame(three_channels, isRectified(depth_topic));
  FrameMessages result = messages;
  const auto color = imageMessage(frame.color, messages.color->header);
  color->encoding = frame.color_order == ColorOrder::kRgb ? enc::RGB8 : enc::BGR8;
  result.color = color;
  result.depth = imageMessage(frame.depth, messages.depth->header);
  result.camera_info =
      boost::make_shared<sensor_msgs::CameraInfo>(cameraInfo(frame.color_camera, messages.camera_info->header));
  return result;
}

sensor_msgs::ImageConstPtr colorWithThreeChannels(const sensor_msgs::ImageConstPtr& image) {
  const auto found = convertedEncodings().find(image->encoding);
  if (found == convertedEncodings().end()) return image;
  const auto [type, conversion] = found->second;
  cv::Mat pixels = view(*image, type, "colour"), bgr;
  require(type != CV_8UC2 || pixels.cols % 2 == 0, "colour image of yuv422 has an odd width");
  if (CV_MAT_DEPTH(type) == CV_16U) pixels.convertTo(pixels, CV_8U, 1.0 / 257.0);
  if (conversion < 0)
    bgr = pixels;
  else
    cv::cvtColor(pixels, bgr, conversion);
  return imageMessage(bgr, image->header);
}

sensor_msgs::ImagePtr depthFromPoints(const sensor_msgs::PointCloud2& cloud) {
  require(cloud.height > 1,
          "point cloud is unorganised (height " + std::to_string(cloud.height) + "): no depth image can be made of it");
  require(!cloud.is_bigendian, "point cloud is big-endian; only little-endian is read");
  const sensor_msgs::PointField* z = nullptr;
  for (const auto& field : cloud.fields)
    if (field.name == "z") z = &field;
  require(z && z->datatype == sensor_msgs::PointField::FLOAT32, "point cloud has no float field z");
  require(cloud.width > 0 && cloud.width <= 16384 && cloud.height <= 16384 && cloud.point_step >= z->offset + 4ull &&
              cloud.row_step >= static_cast<std::uint64_t>(cloud.width) * cloud.point_step &&
              cloud.data.size() >= static_cast<std::uint64_t>(cloud.row_step) * cloud.height,
          "point cloud of " + std::to_string(cloud.width) + "x" + std::to_string(cloud.height) +
              " points has sizes that do not fit (" + std::to_string(cloud.data.size()) + " bytes, row step " +
              std::to_string(cloud.row_step) + ", point step " + std::to_string(cloud.point_step) + ")");
  cv::Mat depth(static_cast<int>(cloud.height), static_cast<int>(cloud.width), CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    const std::uint8_t* point = cloud.data.data() + static_cast<size_t>(v) * cloud.row_step + z->offset;
    for (int u = 0; u < depth.cols; ++u, point += cloud.point_step)
      std::memcpy(depth.ptr<float>(v) + u, point, sizeof(float));
  }
  return imageMessage(depth, cloud.header);
}

void fillImage(const cv::Mat& pixels, const std_msgs::Header& header, sensor_msgs::Image* image) {
  const size_t row = pixels.cols * pixels.elemSize();
  image->header = header;
  image->width = static_cast<std::uint32_t>(pixels.cols);
  image->height = static_cast<std::uint32_t>(pixels.rows);
  image->encoding = encodingOf(pixels.type());
  image->step = static_cast<std::uint32_t>(row);
  image->data.resize(row * pixels.rows);
  for (int v = 0; v < pixels.rows; ++v) std::memcpy(image->data.data() + v * row, pixels.ptr(v), row);
}

sensor_msgs::ImagePtr imageMessage(const cv::Mat& pixels, const std_msgs::Header& header) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  fillImage(pixels, header, image.get());
  return image;
}

}  // namespace recognition
