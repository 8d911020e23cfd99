#include "rgbd_recognition/core/frame.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

std::string sizeText(const cv::Mat& image) { return std::to_string(image.cols) + "x" + std::to_string(image.rows); }

void require(bool good, const std::string& message) {
  if (!good) throw std::invalid_argument("frame: " + message);
}

}  // namespace

CameraModel RgbdFrame::depthCamera() const {
  CameraModel camera = color_camera.scaled(1.0 / colorPerDepthPixel());
  camera.width = depth.cols;
  camera.height = depth.rows;
  return camera;
}

void RgbdFrame::validate() const {
  require(!color.empty(), "colour image is empty");
  require(!depth.empty(), "depth image is empty");
  require(color.type() == CV_8UC3, "colour image is not 8-bit with three channels");
  require(depth.type() == CV_16UC1 || depth.type() == CV_32FC1, "depth image is neither 16UC1 (mm) nor 32FC1 (m)");
  require(color.cols == color.rows || color.cols != depth.rows || color.rows != depth.cols,
          "colour " + sizeText(color) + " lies across depth " + sizeText(depth) +
              ": one of them was rotated (as by EXIF); rotate it back");
  require(color.cols % depth.cols == 0 && color.rows / depth.rows >= color.cols / depth.cols,
          "colour " + sizeText(color) + " is no integer multiple of depth " + sizeText(depth));
  color_camera.validate();
  require(color_camera.width == color.cols && color_camera.height == color.rows,
          "camera info is for " + std::to_string(color_camera.width) + "x" + std::to_string(color_camera.height) +
              ", the colour image is " + sizeText(color));
}

cv::Mat depthInMetres(const cv::Mat& depth) {
  if (depth.type() != CV_16UC1 && depth.type() != CV_32FC1)
    throw std::invalid_argument("depth image is neither 16UC1 (mm) nor 32FC1 (m)");
  cv::Mat metres;
  if (depth.type() == CV_16UC1) {
    depth.convertTo(metres, CV_32F, 0.001);
    return metres;
  }
  metres.create(depth.size(), CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    const float* from = depth.ptr<float>(v);
    float* to = metres.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u)
      to[u] = from[u] > 0.0f && from[u] <= std::numeric_limits<float>::max() ? from[u] : 0.0f;
  }
  return metres;
}

cv::Mat toGray(const cv::Mat& color, ColorOrder order) {
  cv::Mat gray;
  cv::cvtColor(color, gray, order == ColorOrder::kBgr ? cv::COLOR_BGR2GRAY : cv::COLOR_RGB2GRAY);
  return gray;
}

cv::Mat bgrCopy(const RgbdFrame& frame) {
  if (frame.color_order == ColorOrder::kBgr) return frame.color.clone();
  cv::Mat bgr;
  cv::cvtColor(frame.color, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

cv::Mat toCielab(const cv::Mat& color, ColorOrder order, int color_per_depth, cv::Size depth_size) {
  cv::Mat small = color;
  if (color_per_depth > 1) {
    const cv::Mat covered =
        color(cv::Rect(0, 0, depth_size.width * color_per_depth, depth_size.height * color_per_depth));
    cv::resize(covered, small, depth_size, 0, 0, cv::INTER_AREA);
  } else if (color.rows > depth_size.height) {
    small = color.rowRange(0, depth_size.height);
  }
  cv::Mat scaled, lab;
  small.convertTo(scaled, CV_32FC3, 1.0 / 255.0);
  cv::cvtColor(scaled, lab, order == ColorOrder::kBgr ? cv::COLOR_BGR2Lab : cv::COLOR_RGB2Lab);
  return lab;
}

}  // namespace recognition
