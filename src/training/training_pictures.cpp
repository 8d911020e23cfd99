#include "training/training_pictures.h"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/angles.h"
#include "rgbd_recognition/segmentation/segmentation.h"
#include "training/object_region.h"
#include "training/object_view.h"
#include "training/training_quality.h"

namespace recognition {
namespace {

constexpr int kSide = 400;       // of the coverage picture, pixels
constexpr int kMargin = 30;      // around its disc
constexpr double kAxis = 0.1;    // length of the board's drawn axes, metres
constexpr int kElevations = 30;  // degrees between the drawn circles
const cv::Scalar kDark(48, 48, 48), kUnseen(90, 90, 90), kSeen(80, 160, 60), kLine(150, 150, 150), kDot(255, 255, 255),
    kNow(0, 200, 255);

double radiusOf(double elevation) { return (0.5 * kSide - kMargin) * (1.0 - elevation / (0.5 * kPi)); }

cv::Point2d placeOf(const Eigen::Vector3f& direction) {
  const double elevation = std::asin(std::clamp(static_cast<double>(direction.z()), 0.0, 1.0));
  const double azimuth = std::atan2(direction.y(), direction.x());
  return {0.5 * kSide + radiusOf(elevation) * std::cos(azimuth), 0.5 * kSide - radiusOf(elevation) * std::sin(azimuth)};
}

Eigen::Vector3f directionAt(const cv::Point& pixel) {
  const double x = pixel.x - 0.5 * kSide, y = 0.5 * kSide - pixel.y;
  const double elevation = 0.5 * kPi * (1.0 - std::hypot(x, y) / radiusOf(0.0)), azimuth = std::atan2(y, x);
  return Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                         std::sin(elevation))
      .cast<float>();
}

void write(cv::Mat& picture, const std::string& text, const cv::Point& at) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(), 3, cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, kDot, 1, cv::LINE_AA);
}

void drawAxes(cv::Mat& picture, const CameraModel& camera, const Pose& camera_from_board) {
  const Eigen::Vector3d origin = camera_from_board.translation();
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d tip = camera_from_board * (kAxis * Eigen::Vector3d::Unit(axis));
    if (origin.z() <= 0.0 || tip.z() <= 0.0) continue;
    const Eigen::Vector2d a = camera.project(origin), b = camera.project(tip);
    cv::Scalar color;
    color[2 - axis] = 255;
    cv::arrowedLine(picture, cv::Point2d(a.x(), a.y()), cv::Point2d(b.x(), b.y()), color, 2, cv::LINE_AA);
  }
}

}  // namespace

cv::Mat cutOutObject(const RecordedView& recorded, const RecordingParameters& parameters) {
  if (!recorded.mask.empty()) return recorded.mask;
  if (!recorded.camera_from_world) return cv::Mat(recorded.frame.depth.size(), CV_8UC1, cv::Scalar(0));
  std::vector<ObjectView> views = {makeObjectView(recorded.frame)};
  views.front().camera_from_world = *recorded.camera_from_world;
  try {
    return maskOfRegion(views.front(), findObjectRegion(views, parameters));
  } catch (const std::runtime_error&) {  // nothing stands there
    return cv::Mat(recorded.frame.depth.size(), CV_8UC1, cv::Scalar(0));
  }
}

cv::Mat drawTrainingView(const RgbdFrame& frame, const std::optional<Pose>& camera_from_board, const cv::Mat& object,
                         const std::string& text) {
  cv::Mat picture = bgrCopy(frame);
  const cv::Mat mask = toColorSize(object, frame.color.size(), frame.colorPerDepthPixel());
  cv::Mat darkened;
  picture.convertTo(darkened, -1, 0.4);
  darkened.copyTo(picture, mask == 0);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
  cv::drawContours(picture, outlines, -1, kNow, 2);
  if (camera_from_board) drawAxes(picture, frame.color_camera, *camera_from_board);
  write(picture, text, {10, picture.rows - 12});
  return picture;
}

cv::Mat drawCoverage(const std::vector<Eigen::Vector3f>& view_directions, const std::optional<Eigen::Vector3f>& now) {
  cv::Mat picture(kSide, kSide, CV_8UC3, kDark);
  for (int v = 0; v < kSide; ++v)
    for (int u = 0; u < kSide; ++u) {
      const Eigen::Vector3f direction = directionAt({u, v});
      if (direction.z() < 0.0f || std::hypot(u - 0.5 * kSide, v - 0.5 * kSide) > radiusOf(0.0)) continue;
      const cv::Scalar& color = isCovered(direction, view_directions) ? kSeen : kUnseen;
      picture.at<cv::Vec3b>(v, u) =
          cv::Vec3b(static_cast<uchar>(color[0]), static_cast<uchar>(color[1]), static_cast<uchar>(color[2]));
    }
  for (int elevation = 0; elevation < 90; elevation += kElevations)
    cv::circle(picture, cv::Point(kSide / 2, kSide / 2), cvRound(radiusOf(elevation * kPi / 180.0)), kLine, 1,
               cv::LINE_AA);
  for (const Eigen::Vector3f& direction : view_directions) cv::circle(picture, placeOf(direction), 3, kDot, -1);
  if (now && now->z() > 0.0f) cv::circle(picture, placeOf(*now), 8, kNow, 2, cv::LINE_AA);
  write(picture,
        cv::format("%d views, %.0f %% of the upper directions", static_cast<int>(view_directions.size()),
                   100.0 * coverageOf(view_directions)),
        {8, kSide - 8});
  return picture;
}

}  // namespace recognition
