#include "openni2/kinect_dump.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "openni2/depth_warp.h"
#include "openni2/kinect_depth.h"
#include "openni2/virtual_recording.h"

namespace recognition::openni2 {
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

void writeKinectDump(const std::string& recording_directory, const std::string& directory, double seconds) {
  const VirtualRecording recording(recording_directory);
  fs::remove_all(directory);
  fs::create_directories(directory);
  std::ofstream index(fs::path(directory) / "INDEX.txt");
  std::vector<std::string> written;  // the stamps in the first names of the recording's frames
  for (int frame = 0; frame < seconds * kRate; ++frame) {
    const std::string stamp =
        cv::format("%f-%u", kFirstTime + static_cast<double>(frame) / kRate, frame * kTicksPerFrame);
    const std::string color_file = "r-" + stamp + ".ppm";
    const std::string depth_file = "d-" + stamp + ".pgm";
    if (frame < recording.size()) {
      const VirtualRecording::Images images = recording.load(frame);
      write(fs::path(directory) / color_file, "P6 640 480 255", colorImage(images, 640, 480));
      write(fs::path(directory) / depth_file, "P5 640 480 65535", rawDepth(images));
      written.push_back(stamp);
    } else {
      const std::string& first = written[frame % recording.size()];
      fs::create_symlink("r-" + first + ".ppm", fs::path(directory) / color_file);
      fs::create_symlink("d-" + first + ".pgm", fs::path(directory) / depth_file);
    }
    index << color_file << "\n" << depth_file << "\n";
  }
  if (!index) throw std::runtime_error(directory + "/INDEX.txt: cannot be written");
}

}  // namespace recognition::openni2
