#include "rgbd_recognition/annotation.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

cv::Point toPixel(const CameraModel& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector2d m = camera.project(point);
  const auto bounded = [](double value) { return cvRound(std::clamp(value, -1e4, 1e4)); };
  return {bounded(m.x()), bounded(m.y())};
}

/// Silhouette of the projected cloud as a mask at a quarter of the image's size: cheap, and closed for any spacing.
cv::Mat silhouette(const ObjectModel& object, const Pose& pose, const CameraModel& camera) {
  const CameraModel small = camera.scaled(0.25);
  cv::Mat mask = cv::Mat::zeros(small.height, small.width, CV_8UC1);
  for (const SurfacePoint& point : object.cloud) {
    const Eigen::Vector3d p = pose * point.position.cast<double>();
    if (p.z() < 0.05) continue;
    const cv::Point m = toPixel(small, p);
    if (m.x >= 0 && m.y >= 0 && m.x < mask.cols && m.y < mask.rows) mask.at<std::uint8_t>(m) = 255;
  }
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  return mask;
}

void drawOutline(cv::Mat& bgr, const cv::Mat& mask, const cv::Scalar& color, int width) {
  cv::Mat full;
  cv::resize(mask, full, bgr.size(), 0, 0, cv::INTER_LINEAR);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(full > 127, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
  cv::drawContours(bgr, contours, -1, color, width, cv::LINE_AA);
}

void drawAxes(cv::Mat& bgr, const Pose& pose, const CameraModel& camera, int width) {
  if (pose.translation().z() < 0.1) return;
  const cv::Scalar colors[] = {{0, 0, 255}, {0, 255, 0}, {255, 0, 0}};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d tip = pose * (0.05 * Eigen::Vector3d::Unit(axis));
    if (tip.z() > 0.05)
      cv::line(bgr, toPixel(camera, pose.translation()), toPixel(camera, tip), colors[axis], width, cv::LINE_AA);
  }
}

void drawLabel(cv::Mat& bgr, const std::string& text, cv::Point at, const cv::Scalar& color) {
  const double scale = bgr.cols >= 1000 ? 0.8 : 0.45;
  int baseline = 0;
  const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &baseline);
  at.x = std::clamp(at.x - size.width / 2, 0, std::max(0, bgr.cols - size.width));
  at.y = std::clamp(at.y, size.height + 2, std::max(size.height + 2, bgr.rows - baseline));
  cv::rectangle(bgr, {at.x - 2, at.y - size.height - 2}, {at.x + size.width + 2, at.y + baseline}, {0, 0, 0},
                cv::FILLED);
  cv::putText(bgr, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, color, 1, cv::LINE_AA);
}

}  // namespace

std::string nameWithConfidence(const std::string& name, double confidence) {
  return name + cv::format(" %.2f", confidence);
}

cv::Scalar objectColor(int object) {
  // Golden-ratio steps round the colour circle keep neighbours apart.
  const float hue = std::fmod(0.61803398875f * static_cast<float>(object + 1), 1.0f) * 180.0f;
  cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar(hue, 200, 255)), bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  const cv::Vec3b c = bgr.at<cv::Vec3b>(0, 0);
  return {double(c[0]), double(c[1]), double(c[2])};
}

void drawAnnotations(cv::Mat& bgr, const std::vector<Annotation>& annotations, const ModelDatabase& database,
                     const CameraModel& camera) {
  const int width = bgr.cols >= 1000 ? 3 : 2;
  for (const Annotation& annotation : annotations) {
    const ObjectModel& object = *database.objects.at(static_cast<size_t>(annotation.object));
    const cv::Mat mask = silhouette(object, annotation.camera_from_object, camera);
    drawOutline(bgr, mask, objectColor(annotation.object), width);
    drawAxes(bgr, annotation.camera_from_object, camera, width);
  }
  for (const Annotation& annotation : annotations) {
    if (annotation.camera_from_object.translation().z() < 0.05) continue;
    const cv::Point centre = toPixel(camera, annotation.camera_from_object.translation());
    drawLabel(bgr, annotation.label, centre, objectColor(annotation.object));
  }
}

}  // namespace recognition
