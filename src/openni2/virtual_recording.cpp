#include "openni2/virtual_recording.h"

#include <algorithm>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "openni2/depth_warp.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition::openni2 {
namespace {

namespace fs = std::filesystem;

std::vector<BopFrame> readFrames(const std::string& directory) {
  fs::path folder = fs::path(directory).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  if (!fs::is_directory(folder)) throw std::runtime_error(directory + ": no such folder");
  if (!fs::exists(folder / "scene_camera.json")) return readBopSplit(folder.string());
  const std::string name = folder.filename().string();
  if (name.find_first_not_of("0123456789") != std::string::npos || name.size() > 9)
    throw std::runtime_error(directory + ": a scene's folder has a number as its name");
  const int scene = std::stoi(name);
  std::vector<BopFrame> frames = readBopSplit(folder.parent_path().string());
  frames.erase(std::remove_if(frames.begin(), frames.end(), [scene](const BopFrame& f) { return f.scene != scene; }),
               frames.end());
  return frames;
}

cv::Mat toSize(const cv::Mat& image, int width, int height, int interpolation) {
  cv::Mat scaled = image;
  if (image.cols != width) {
    cv::resize(image, scaled, cv::Size(width, image.rows * width / image.cols), 0, 0, interpolation);
  }
  if (scaled.rows == height) return scaled;
  cv::Mat fitted(height, width, image.type(), cv::Scalar::all(0));
  const cv::Rect common(0, 0, width, std::min(height, scaled.rows));
  scaled(common).copyTo(fitted(common));
  return fitted;
}

}  // namespace

VirtualRecording::VirtualRecording(const std::string& directory) : frames_(readFrames(directory)) {
  if (frames_.empty()) throw std::runtime_error(directory + ": a recording without frames");
  color_camera_ = load(0).color_camera;
}

VirtualRecording::Images VirtualRecording::load(int frame) const {
  const RgbdFrame recorded = loadBopFrame(frames_[frame]);
  Images images;
  images.color_camera = recorded.color_camera;
  if (recorded.color_order == ColorOrder::kBgr) {
    cv::cvtColor(recorded.color, images.rgb, cv::COLOR_BGR2RGB);
  } else {
    images.rgb = recorded.color;
  }
  recorded.depth.convertTo(images.depth_mm, CV_16UC1, recorded.depth.type() == CV_32FC1 ? 1000.0 : 1.0);
  return images;
}

cv::Mat colorImage(const VirtualRecording::Images& images, int width, int height) {
  return toSize(images.rgb, width, height, width < images.rgb.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
}

cv::Mat infraredImage(const VirtualRecording::Images& images, int width, int height) {
  cv::Mat gray, infrared;
  cv::cvtColor(colorImage(images, width, height), gray, cv::COLOR_RGB2GRAY);
  gray.convertTo(infrared, CV_16UC1, 4.0);
  return infrared;
}

cv::Mat depthImage(const VirtualRecording::Images& images, int width, int height, bool registered) {
  const cv::Mat depth = toSize(images.depth_mm, width, height, cv::INTER_NEAREST);
  if (registered) return depth;
  CameraModel camera = images.color_camera.scaled(static_cast<double>(width) / images.color_camera.width);
  camera.width = width;
  camera.height = height;
  return warpDepth(depth, camera, camera, kColorCameraRightOfInfrared);
}

}  // namespace recognition::openni2
