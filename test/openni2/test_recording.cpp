#include "openni2/test_recording.h"

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

namespace recognition::openni2 {

namespace fs = std::filesystem;

cv::Vec3b testColor(int index, int u, int v) {
  return cv::Vec3b(static_cast<uchar>(40 + 50 * (index % 4)), static_cast<uchar>(u / 4), static_cast<uchar>(v / 4));
}

int testDepth(int index, int u) { return 800 + 100 * (index % 4) + (u < 320 ? 0 : 400); }

std::string writeTestRecording(const std::string& directory, int frames) {
  const fs::path scene = fs::path(directory) / "000001";
  fs::create_directories(scene / "rgb");
  fs::create_directories(scene / "depth");
  std::ofstream cameras(scene / "scene_camera.json");
  std::ofstream poses(scene / "scene_gt.json");
  cameras << "{";
  poses << "{";
  for (int index = 0; index < frames; ++index) {
    cv::Mat bgr(480, 640, CV_8UC3);
    cv::Mat depth(480, 640, CV_16UC1);
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) {
        const cv::Vec3b rgb = testColor(index, u, v);
        bgr.at<cv::Vec3b>(v, u) = cv::Vec3b(rgb[2], rgb[1], rgb[0]);
        depth.at<uint16_t>(v, u) = static_cast<uint16_t>(testDepth(index, u));
      }
    }
    const std::string name = cv::format("%06d.png", index);
    cv::imwrite((scene / "rgb" / name).string(), bgr);
    cv::imwrite((scene / "depth" / name).string(), depth);
    const char* comma = index == 0 ? "" : ",";
    cameras << comma << "\"" << index
            << "\": {\"cam_K\": [525, 0, 310.0, 0, 525, 245.0, 0, 0, 1], \"depth_scale\": 1.0}";
    poses << comma << "\"" << index << "\": []";
  }
  cameras << "}";
  poses << "}";
  return scene.string();
}

void plugIn(const std::string& bus, const std::string& port, const std::string& source, const std::string& serial,
            const std::string& access) {
  std::ofstream file(fs::path(bus) / (port + ".kinect.new"));
  file << "source: " << source << "\n";
  if (!serial.empty()) file << "serial: " << serial << "\n";
  if (!access.empty()) file << "access: " << access << "\n";
  file.close();
  fs::rename(fs::path(bus) / (port + ".kinect.new"), fs::path(bus) / (port + ".kinect"));
}

void plugOut(const std::string& bus, const std::string& port) { fs::remove(fs::path(bus) / (port + ".kinect")); }

}  // namespace recognition::openni2
