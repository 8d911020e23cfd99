#include "rgbd_recognition/ros/image_conversions.h"

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

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

}  // namespace

cv::Mat colorView(const sensor_msgs::Image& image, ColorOrder* order) {
  require(image.encoding == enc::RGB8 || image.encoding == enc::BGR8 || image.encoding == enc::TYPE_8UC3,
          "colour image has encoding '" + image.encoding + "'; rgb8, bgr8, rgba8 and bgra8 are read");
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
  require(info.P[0] > 0.0 && info.P[5] > 0.0, "camera info has P[0] = " + std::to_string(info.P[0]) + " and P[5] = " +
                                                  std::to_string(info.P[5]) + ": the camera is not calibrated");
  require(std::isfinite(info.P[0]) && std::isfinite(info.P[5]) && std::isfinite(info.P[2]) && std::isfinite(info.P[6]),
          "camera info's P holds a number that is not finite");
  require(info.binning_x <= kMaxBinning && info.binning_y <= kMaxBinning,
          "camera info has binning " + std::to_string(info.binning_x) + "x" + std::to_string(info.binning_y));
  const int bin_x = std::max(1u, info.binning_x), bin_y = std::max(1u, info.binning_y);
  const bool whole = info.roi.width == 0 || info.roi.height == 0;
  CameraModel camera;
  camera.width = static_cast<int>(whole ? info.width : info.roi.width) / bin_x;
  camera.height = static_cast<int>(whole ? info.height : info.roi.height) / bin_y;
  camera.fx = info.P[0] / bin_x;
  camera.fy = info.P[5] / bin_y;
  // Integers are pixel centres: a binned pixel's centre lies in the middle of those it covers.
  camera.cx = (info.P[2] - info.roi.x_offset + 0.5) / bin_x - 0.5;
  camera.cy = (info.P[6] - info.roi.y_offset + 0.5) / bin_y - 0.5;
  return camera;
}

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

RgbdFrame frameView(const FrameMessages& messages) {
  RgbdFrame frame;
  frame.color = colorView(*messages.color, &frame.color_order);
  frame.depth = depthView(*messages.depth);
  frame.color_camera = cameraFromInfo(*messages.camera_info);
  const std::string color_id = plainFrame(messages.color->header.frame_id);
  const std::string depth_id = plainFrame(messages.depth->header.frame_id);
  require(color_id == depth_id, "depth image is in frame '" + depth_id + "', colour in '" + color_id +
                                    "': depth is not registered to colour");
  frame.validate();
  return frame;
}

sensor_msgs::ImageConstPtr colorWithThreeChannels(const sensor_msgs::ImageConstPtr& image) {
  const bool rgba = image->encoding == enc::RGBA8;
  if (!rgba && image->encoding != enc::BGRA8) return image;
  cv::Mat bgr;
  cv::cvtColor(view(*image, CV_8UC4, "colour"), bgr, rgba ? cv::COLOR_RGBA2BGR : cv::COLOR_BGRA2BGR);
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
