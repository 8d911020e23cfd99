#include "rgbd_recognition/evaluation/bop_dataset.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

namespace recognition {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

[[noreturn]] void fail(const std::string& file, const std::string& reason) {
  throw std::runtime_error(file + ": " + reason);
}

json readJson(const fs::path& file) {
  std::ifstream in(file);
  if (!in) fail(file.string(), "cannot be read");
  try {
    return json::parse(in);
  } catch (const json::exception& error) {
    fail(file.string(), error.what());
  }
}

/// rgb/000000.png or .jpg (gray/ where there is no rgb/).
std::string findImage(const fs::path& scene, const std::string& stem) {
  for (const char* folder : {"rgb", "gray"})
    for (const char* ending : {".png", ".jpg", ".tif"})
      if (fs::exists(scene / folder / (stem + ending))) return (scene / folder / (stem + ending)).string();
  fail((scene / "rgb" / stem).string(), "no colour image (.png, .jpg)");
}

void readCamera(const json& entry, CameraModel& camera, double& depth_scale) {
  const auto k = entry.at("cam_K").get<std::vector<double>>();
  if (k.size() != 9) throw std::runtime_error("cam_K has " + std::to_string(k.size()) + " numbers, not 9");
  camera.fx = k[0];
  camera.cx = k[2];
  camera.fy = k[4];
  camera.cy = k[5];
  depth_scale = entry.value("depth_scale", 1.0);
}

Pose readPose(const json& entry) {
  const auto r = entry.at("cam_R_m2c").get<std::vector<double>>();
  const auto t = entry.at("cam_t_m2c").get<std::vector<double>>();
  if (r.size() != 9 || t.size() != 3) throw std::runtime_error("cam_R_m2c or cam_t_m2c has the wrong length");
  Pose pose = Pose::Identity();
  for (int i = 0; i < 9; ++i) pose.linear()(i / 3, i % 3) = r[static_cast<size_t>(i)];
  pose.translation() = Eigen::Vector3d(t[0], t[1], t[2]) * 0.001;  // BOP: millimetres
  return pose;
}

std::vector<GroundTruth> readGroundTruth(const json& instances, const json& info) {
  std::vector<GroundTruth> result;
  for (size_t i = 0; i < instances.size(); ++i) {
    GroundTruth truth;
    truth.object_id = instances[i].at("obj_id").get<int>();
    truth.camera_from_object = readPose(instances[i]);
    if (i < info.size()) truth.visibility = info[i].value("visib_fract", -1.0);
    result.push_back(truth);
  }
  return result;
}

std::vector<BopFrame> readScene(const fs::path& scene) {
  const json cameras = readJson(scene / "scene_camera.json");
  const json truths = fs::exists(scene / "scene_gt.json") ? readJson(scene / "scene_gt.json") : json::object();
  const json infos = fs::exists(scene / "scene_gt_info.json") ? readJson(scene / "scene_gt_info.json") : json::object();
  std::vector<BopFrame> frames;
  for (const auto& [key, camera] : cameras.items()) {
    try {
      BopFrame frame;
      frame.scene = std::stoi(scene.filename().string());
      frame.frame = std::stoi(key);
      frame.color_file = findImage(scene, sixDigits(frame.frame));
      frame.depth_file = (scene / "depth" / (sixDigits(frame.frame) + ".png")).string();
      readCamera(camera, frame.camera, frame.depth_scale);
      if (truths.contains(key)) frame.ground_truth = readGroundTruth(truths.at(key), infos.value(key, json::array()));
      frames.push_back(frame);
    } catch (const std::exception& error) {
      fail(scene.string(), "frame '" + key + "': " + error.what());
    }
  }
  return frames;
}

cv::Mat readImage(const std::string& file, int flags) {
  const cv::Mat image = cv::imread(file, flags);
  if (image.empty()) fail(file, "cannot be read as an image");
  return image;
}

}  // namespace

std::string sixDigits(int number) {
  char text[16];
  std::snprintf(text, sizeof text, "%06d", number);
  return text;
}

std::string BopFrame::name() const { return sixDigits(scene) + "/" + sixDigits(frame); }

std::vector<BopFrame> readBopSplit(const std::string& split_directory) {
  if (!fs::is_directory(split_directory)) fail(split_directory, "is no directory");
  std::vector<BopFrame> frames;
  for (const auto& entry : fs::directory_iterator(split_directory)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || name.empty() || name.size() > 9) continue;
    if (!std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c); })) continue;
    const auto scene = readScene(entry.path());
    frames.insert(frames.end(), scene.begin(), scene.end());
  }
  if (frames.empty()) fail(split_directory, "holds no scene folders (NNNNNN with scene_camera.json)");
  std::sort(frames.begin(), frames.end(), [](const BopFrame& a, const BopFrame& b) {
    return std::make_pair(a.scene, a.frame) < std::make_pair(b.scene, b.frame);
  });
  return frames;
}

RgbdFrame loadBopFrame(const BopFrame& source) {
  RgbdFrame frame;
  frame.color = readImage(source.color_file, cv::IMREAD_COLOR);
  const cv::Mat raw = readImage(source.depth_file, cv::IMREAD_UNCHANGED);
  if (raw.type() != CV_16UC1) fail(source.depth_file, "is no 16-bit image with one channel");
  raw.convertTo(frame.depth, CV_32F, source.depth_scale * 0.001);
  frame.color_camera = source.camera;
  frame.color_camera.width = frame.color.cols;
  frame.color_camera.height = frame.color.rows;
  try {
    frame.validate();
  } catch (const std::invalid_argument& error) {
    fail(source.color_file, error.what());
  }
  return frame;
}

RgbdFrame loadFrameFiles(const std::string& color_file, const std::string& depth_file, const std::string& camera_file) {
  BopFrame source;
  source.color_file = color_file;
  source.depth_file = depth_file;
  json camera = readJson(camera_file);
  try {
    if (!camera.contains("cam_K") && !camera.empty()) camera = camera.begin().value();
    readCamera(camera, source.camera, source.depth_scale);
  } catch (const std::exception& error) {
    fail(camera_file, error.what());
  }
  return loadBopFrame(source);
}

}  // namespace recognition
