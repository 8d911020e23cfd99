#include "openni2/kinect_dump.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "openni2/depth_warp.h"
#include "openni2/kinect_depth.h"
#include "openni2/virtual_recording.h"

namespace rgbd_recognition::openni2 {
namespace {

namespace fs = std::filesystem;

constexpr int kRate = 30;
constexpr double kFirstTime = 1000.0;  // s
constexpr uint32_t kTicksPerFrame = 60000000 / kRate;

void write(const fs::path& file, const std::string& header, const cv::Mat& image) {
  std::ofstream out(file, std::ios::binary);
  out << header << "\n";
  out.write(image.ptr<char>(), static_cast<std::streamsize>(image.total() * image.elemSize()));
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

cv::Mat rawDepth(const VirtualRecording::Images& images) {
  cv::Mat depth = warpDepth(depthImage(images, 640, 480, true), typicalColorCamera(), typicalInfraredCamera(),
                            kColorCameraRightOfInfrared);
  std::transform(depth.begin<uint16_t>(), depth.end<uint16_t>(), depth.begin<uint16_t>(),
                 [](uint16_t millimetres) { return rawOfMillimetres(millimetres); });
  return depth;
}

}  // namespace

void writeKinectDump(const std::string& recording_directory, const std::string& directory) {
  const VirtualRecording recording(recording_directory);
  fs::create_directories(directory);
  std::ofstream index(fs::path(directory) / "INDEX.txt");
  for (int frame = 0; frame < recording.size(); ++frame) {
    const VirtualRecording::Images images = recording.load(frame);
    const std::string stamp =
        cv::format("%f-%u", kFirstTime + static_cast<double>(frame) / kRate, frame * kTicksPerFrame);
    write(fs::path(directory) / ("r-" + stamp + ".ppm"), "P6 640 480 255", colorImage(images, 640, 480));
    write(fs::path(directory) / ("d-" + stamp + ".pgm"), "P5 640 480 65535", rawDepth(images));
    index << "r-" << stamp << ".ppm\nd-" << stamp << ".pgm\n";
  }
  if (!index) throw std::runtime_error(directory + "/INDEX.txt: cannot be written");
}

}  // namespace rgbd_recognition::openni2
