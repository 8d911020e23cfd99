#include <cctype>
#include <filesystem>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

#include "evaluation/camera_file.h"
#include "evaluation/frame_files.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"

namespace recognition {
namespace {

[[noreturn]] void refuse(const std::string& file, const std::string& reason) {
  throw std::runtime_error(file + ": " + reason);
}

/// Rows as they are stored: depth knows nothing of EXIF.
cv::Mat readImage(const std::string& file, int flags) {
  if (!std::filesystem::is_regular_file(file)) refuse(file, "is no file");
  cv::Mat image;
  try {
    image = cv::imread(file, flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {  // as for a size that is not plausible
  }
  if (image.empty()) refuse(file, "cannot be read as an image");
  return image;
}

cv::Mat readDepth(const std::string& file, double depth_scale) {
  const cv::Mat raw = readImage(file, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR);
  if (raw.type() != CV_16UC1 && raw.type() != CV_32FC1)
    refuse(file, raw.depth() == CV_8U ? "is an image of 8 bits; depth has 16, in millimetres, or float"
                                      : "is no depth image: 16 bits, or float, with one channel");
  cv::Mat depth;
  raw.convertTo(depth, CV_32F, depth_scale * 0.001);
  return depth;
}

/// The number that a file's name ends with.
std::optional<int> numberOf(const std::string& file) {
  const std::string stem = std::filesystem::path(file).stem().string();
  size_t first = stem.size();
  while (first > 0 && std::isdigit(static_cast<unsigned char>(stem[first - 1]))) --first;
  if (first == stem.size() || stem.size() - first > 9) return std::nullopt;
  return std::stoi(stem.substr(first));
}

void requireSize(const std::string& camera_file, const CameraModel& camera, const cv::Mat& color) {
  if (camera.width == 0 || camera.height == 0 || (camera.width == color.cols && camera.height == color.rows)) return;
  refuse(camera_file, "is the camera of " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                          " pixels, the colour image has " + std::to_string(color.cols) + "x" +
                          std::to_string(color.rows));
}

void validate(const RgbdFrame& frame, const std::string& file) {
  try {
    frame.validate();
  } catch (const std::invalid_argument& error) {
    refuse(file, error.what());
  }
}

}  // namespace

RgbdFrame loadBopFrame(const BopFrame& source) {
  RgbdFrame frame;
  frame.color = readImage(source.color_file, cv::IMREAD_COLOR);
  frame.depth = readDepth(source.depth_file, source.depth_scale);
  frame.color_camera = source.camera;
  frame.color_camera.width = frame.color.cols;
  frame.color_camera.height = frame.color.rows;
  validate(frame, source.color_file);
  return frame;
}

bool isDistorted(const std::string& color_file, const std::string& camera_file) {
  return readCameraFile(camera_file, numberOf(color_file)).distortion.isThere();
}

RgbdFrame loadFrameFiles(const std::string& color_file, const std::string& depth_file, const std::string& camera_file) {
  CameraFile file = readCameraFile(camera_file, numberOf(color_file));
  BopFrame source;
  source.color_file = color_file;
  source.depth_file = depth_file;
  source.camera = file.camera;
  source.depth_scale = file.depth_scale;
  const RgbdFrame frame = loadBopFrame(source);
  requireSize(camera_file, file.camera, frame.color);
  if (!file.distortion.isThere()) return frame;
  CameraModel rectified = file.rectified ? *file.rectified : frame.color_camera;
  rectified.width = frame.color.cols, rectified.height = frame.color.rows;
  try {
    return undistorted(frame, file.distortion, rectified);
  } catch (const std::invalid_argument& error) {
    refuse(camera_file, error.what());
  }
}

}  // namespace recognition
