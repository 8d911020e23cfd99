#include "benchmarks/segmentation_quality.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

namespace recognition {
namespace {

namespace fs = std::filesystem;

constexpr int kObjectStep = 10;  ///< labels of one object
constexpr int kFirstObject = 10;

std::vector<fs::path> filesOf(const fs::path& directory, const std::string& extension) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory))
    if (entry.path().extension() == extension) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

DepthFrame frameOfCloud(const fs::path& file) {
  pcl::PointCloud<pcl::PointXYZL> cloud;
  if (pcl::io::loadPCDFile(file.string(), cloud) != 0) throw std::runtime_error(file.string() + ": cannot be read");
  const int width = static_cast<int>(cloud.width), height = static_cast<int>(cloud.height);
  DepthFrame frame{file.stem().string(),
                   cv::Mat(height, width, CV_32FC1),
                   cv::Mat(height, width, CV_32SC1),
                   {width, height, 525.0, 525.0, 0.5 * (width - 1), 0.5 * (height - 1)}};
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const pcl::PointXYZL& point = cloud.at(u, v);
      frame.depth.at<float>(v, u) = point.z > 0.0f ? point.z : 0.0f;
      frame.labels.at<int>(v, u) = static_cast<int>(point.label);
    }
  }
  return frame;
}

void readBopScene(const fs::path& scene, std::vector<DepthFrame>* frames) {
  const nlohmann::json cameras = nlohmann::json::parse(std::ifstream(scene / "scene_camera.json"));
  for (const fs::path& file : filesOf(scene / "depth", ".png")) {
    const auto& camera = cameras.at(std::to_string(std::stoi(file.stem().string())));
    const auto& k = camera.at("cam_K");
    const cv::Mat raw = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
    if (raw.type() != CV_16UC1) throw std::runtime_error(file.string() + ": no 16-bit depth image");
    DepthFrame frame;
    frame.name = scene.filename().string() + "/" + file.stem().string();
    raw.convertTo(frame.depth, CV_32F, 0.001 * camera.at("depth_scale").get<double>());
    frame.camera = {raw.cols, raw.rows, k[0].get<double>(), k[4].get<double>(), k[2].get<double>(), k[5].get<double>()};
    frames->push_back(frame);
  }
}

/// Most frequent key.
int majority(const std::map<int, int>& votes) {
  return std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

int objectOf(int label) { return label / kObjectStep; }

}  // namespace

std::vector<DepthFrame> readLabelledClouds(const std::string& directory) {
  std::vector<DepthFrame> frames;
  for (const fs::path& file : filesOf(directory, ".pcd")) frames.push_back(frameOfCloud(file));
  if (frames.empty()) throw std::runtime_error(directory + ": no .pcd file");
  return frames;
}

std::vector<DepthFrame> readBopDepth(const std::string& split_directory) {
  std::vector<DepthFrame> frames;
  std::vector<fs::path> scenes;
  for (const fs::directory_entry& entry : fs::directory_iterator(split_directory))
    if (fs::exists(entry.path() / "scene_camera.json")) scenes.push_back(entry.path());
  std::sort(scenes.begin(), scenes.end());
  for (const fs::path& scene : scenes) readBopScene(scene, &frames);
  if (frames.empty()) throw std::runtime_error(split_directory + ": no scene with scene_camera.json");
  return frames;
}

void SegmentationQuality::add(const DepthFrame& frame, const cv::Mat& patch_image) {
  std::map<int, std::map<int, int>> objects_of_patch;
  std::set<int> seen;
  for (int v = 0; v < frame.labels.rows; ++v) {
    for (int u = 0; u < frame.labels.cols; ++u) {
      const int label = frame.labels.at<int>(v, u), patch = patch_image.at<int>(v, u);
      if (!(frame.depth.at<float>(v, u) > 0.0f)) continue;
      object_pixels += label >= kFirstObject;
      table_pixels += label > 0 && label < kFirstObject;
      if (label >= kFirstObject) seen.insert(objectOf(label));
      if (patch < 1) continue;
      covered += label >= kFirstObject;
      table_left += label > 0 && label < kFirstObject;
      ++objects_of_patch[patch][label > 0 ? objectOf(label) : -1];
    }
  }
  std::set<int> found;
  for (const auto& patch : objects_of_patch) {
    const int winner = majority(patch.second);
    if (winner > 0) found.insert(winner);
    patches += winner > 0;
    for (const auto& votes : patch.second) mixed += votes.first > 0 && votes.first != winner ? votes.second : 0;
  }
  objects += static_cast<double>(seen.size());
  for (int object : seen) missed += found.count(object) == 0;
}

}  // namespace recognition
