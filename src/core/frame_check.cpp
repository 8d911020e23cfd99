#include "core/frame_check.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "core/short_number.h"

namespace recognition {
namespace {

constexpr double kMinCentre = 0.3, kMaxCentre = 0.7;  // of the picture; beyond in both directions is a corner
constexpr double kMinFocal = 0.2, kMaxFocal = 10.0;   // of the picture's width: 136 and 5.7 degrees wide
constexpr double kMaxSkew = 1.5;                      // between fx and fy
constexpr double kMinMeasured = 0.005;                // of depth's pixels
constexpr double kFew = 0.05;                         // of the measured pixels, which may be wrong
constexpr double kMaxNear = 4.0;  // metres; what is farther than this shows too little to be recognised
constexpr double kMaxPlausible = 60.0;
constexpr double kMinFar = 0.2;
constexpr double kMinNear = 0.12, kCloseFar = 0.5;  // nothing measures so much so near, as a tenth of a room would be
constexpr int kStep = 4;                            // pixels between those that are looked at

std::string sizeText(const CameraModel& camera) {
  return std::to_string(camera.width) + "x" + std::to_string(camera.height);
}

std::string cameraProblem(const CameraModel& camera) {
  const double x = (camera.cx + 0.5) / camera.width, y = (camera.cy + 0.5) / camera.height;
  const std::string centre = "the principal point (" + shortNumber(camera.cx) + ", " + shortNumber(camera.cy) + ") ";
  const std::string hint = "; is the camera that of another resolution, or of another frame?";
  if (x < 0.0 || x > 1.0 || y < 0.0 || y > 1.0)
    return centre + "is outside of the " + sizeText(camera) + " picture" + hint;
  if ((x < kMinCentre && y < kMinCentre) || (x > kMaxCentre && y > kMaxCentre))
    return centre + "is in a corner of the " + sizeText(camera) + " picture" + hint;
  const double focal = camera.fx / camera.width;
  if (focal < kMinFocal || focal > kMaxFocal || camera.fx > kMaxSkew * camera.fy || camera.fy > kMaxSkew * camera.fx)
    return "the focal lengths " + shortNumber(camera.fx) + " and " + shortNumber(camera.fy) + " px do not fit a " +
           sizeText(camera) + " picture" + hint;
  return "";
}

/// Some of the measured pixels, metres.
std::vector<float> sampleDepth(const cv::Mat& depth, size_t* looked_at) {
  std::vector<float> measured;
  const int step = std::min(depth.rows, depth.cols) >= 20 * kStep ? kStep : 1;
  for (int v = 0; v < depth.rows; v += step)
    for (int u = 0; u < depth.cols; u += step) {
      ++*looked_at;
      const float z = depth.type() == CV_16UC1 ? 0.001f * depth.at<std::uint16_t>(v, u) : depth.at<float>(v, u);
      if (z > 0.0f && z < 1e9f) measured.push_back(z);
    }
  return measured;
}

std::string depthProblem(const cv::Mat& depth) {
  size_t looked_at = 0;
  std::vector<float> measured = sampleDepth(depth, &looked_at);
  const double share = static_cast<double>(measured.size()) / static_cast<double>(std::max<size_t>(1, looked_at));
  if (measured.empty()) return "the depth image is empty: no pixel is measured";
  if (share < kMinMeasured) return "only " + shortNumber(100.0 * share) + " % of the depth image are measured";
  const auto few = static_cast<std::ptrdiff_t>(kFew * static_cast<double>(measured.size()));
  std::nth_element(measured.begin(), measured.begin() + few, measured.end());
  const double near = measured[static_cast<size_t>(few)];
  std::nth_element(measured.begin(), measured.end() - 1 - few, measured.end());
  const double far = *(measured.end() - 1 - few);
  if (near > kMaxPlausible)
    return "depth begins at " + shortNumber(near) + " m: is it in millimetres, and read as metres?";
  if (near > kMaxNear)
    return "depth begins at " + shortNumber(near) +
           " m, too far for anything to be recognised; is its scale right, or ten "
           "times too large?";
  if (far < kMinFar || (near < kMinNear && far < kCloseFar))
    return "depth ends at " + shortNumber(far) + " m; is its scale right, or ten or a thousand times too small?";
  return "";
}

}  // namespace

std::string frameProblem(const RgbdFrame& frame) {
  const std::string problem = cameraProblem(frame.color_camera);
  return problem.empty() ? depthProblem(frame.depth) : problem;
}

void requireFit(const RgbdFrame& frame) {
  const std::string problem = frameProblem(frame);
  if (!problem.empty()) throw std::invalid_argument(problem);
}

}  // namespace recognition
