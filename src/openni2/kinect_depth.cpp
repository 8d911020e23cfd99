#include "openni2/kinect_depth.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace recognition::openni2 {
namespace {

constexpr int kRawValues = 2048;
// A typical Kinect's zero plane, as devices report it.
constexpr double kReferenceDistance = 1200.0;   // mm
constexpr double kReferencePixelSize = 0.1042;  // mm, of a full pixel (a 640 wide image has half of them)
constexpr double kEmitterDistance = 75.0;       // mm from infrared camera to projector
constexpr double kRawPerPixel = 4.0;
constexpr double kRawOfReference = 801.5;  // raw value at the reference distance

int triangulate(int raw) {
  const double shift = (raw - kRawOfReference) / kRawPerPixel * kReferencePixelSize * 10.0;
  if (raw >= kNoRawDepth || shift >= kEmitterDistance) return 0;
  const double depth = kReferenceDistance * kEmitterDistance / (kEmitterDistance - shift);
  return depth > kMaxDepth ? 0 : static_cast<int>(std::lround(depth));
}

std::array<uint16_t, kRawValues> makeTable() {
  std::array<uint16_t, kRawValues> table;
  for (int raw = 0; raw < kRawValues; ++raw) table[raw] = static_cast<uint16_t>(triangulate(raw));
  return table;
}

const std::array<uint16_t, kRawValues>& depthTable() {
  static const std::array<uint16_t, kRawValues> table = makeTable();
  return table;
}

CameraModel centredCamera(double focal_length) { return {640, 480, focal_length, focal_length, 319.5, 239.5}; }

}  // namespace

CameraModel typicalColorCamera() { return centredCamera(525.0); }
CameraModel typicalInfraredCamera() { return centredCamera(580.0); }

int millimetresOfRaw(uint16_t raw) { return raw < kRawValues ? depthTable()[raw] : 0; }

uint16_t rawOfMillimetres(int millimetres) {
  if (millimetres <= 0 || millimetres > kMaxDepth) return kNoRawDepth;
  const double shift = kEmitterDistance * (1.0 - kReferenceDistance / millimetres);
  const double raw = shift / (kReferencePixelSize * 10.0) * kRawPerPixel + kRawOfReference;
  return raw < 0.0 ? kNoRawDepth : static_cast<uint16_t>(std::lround(raw));
}

cv::Mat millimetresOfRaw(const cv::Mat& raw) {
  cv::Mat millimetres(raw.size(), CV_16UC1);
  std::transform(raw.begin<uint16_t>(), raw.end<uint16_t>(), millimetres.begin<uint16_t>(),
                 [](uint16_t value) { return static_cast<uint16_t>(millimetresOfRaw(value)); });
  return millimetres;
}

}  // namespace recognition::openni2
