#include "ros/scene_change.h"

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr int kWidth = 80;             // pixels of the small copies
constexpr double kGrayChange = 25.0;   // of 255; the noise of a mean over 8 x 8 pixels is below 3
constexpr double kDepthChange = 0.03;  // of the distance; of a median of 9 pixels
constexpr int kChanged = 3;            // cells: a thing of 3 cm at 1 m covers as many

cv::Mat shrunk(const cv::Mat& image, int interpolation) {
  cv::Mat small;
  cv::resize(image, small, cv::Size(kWidth, std::max(1, kWidth * image.rows / image.cols)), 0, 0, interpolation);
  return small;
}

}  // namespace

SceneChange::Small SceneChange::smallOf(const RgbdFrame& frame) {
  Small small;
  small.gray = toGray(shrunk(frame.color, cv::INTER_AREA), frame.color_order);
  small.depth = shrunk(depthInMetres(frame.depth), cv::INTER_NEAREST);
  cv::patchNaNs(small.depth, 0.0);
  cv::medianBlur(small.depth, small.depth, 3);
  return small;
}

bool SceneChange::isNew(const RgbdFrame& frame, const ros::WallTime& now) const {
  if (longest_rest_ <= 0.0 || worked_.isZero() || (now - worked_).toSec() >= longest_rest_) return true;
  const Small small = smallOf(frame);
  if (small.gray.size() != last_.gray.size() || small.depth.size() != last_.depth.size()) return true;
  cv::Mat difference;
  cv::absdiff(small.gray, last_.gray, difference);
  if (cv::countNonZero(difference > kGrayChange) >= kChanged) return true;
  cv::absdiff(small.depth, last_.depth, difference);
  const cv::Mat known = (small.depth > 0.0f) & (last_.depth > 0.0f);  // holes come and go
  return cv::countNonZero((difference > kDepthChange * last_.depth) & known) >= kChanged;
}

void SceneChange::worked(const RgbdFrame& frame, const ros::WallTime& now) {
  if (longest_rest_ <= 0.0) return;
  last_ = smallOf(frame);
  worked_ = now;
}

}  // namespace recognition
