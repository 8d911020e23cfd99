#include "rgbd_recognition/annotation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr int kShrink = 4;              // of the silhouettes
constexpr double kTextHeight = 0.024;   // of the picture's height, capitals
constexpr double kMinTextHeight = 9.0;  // pixels, below which nobody can read it
constexpr int kPadding = 2;             // pixels round a text

cv::Point toPixel(const CameraModel& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector2d m = camera.project(point);
  const auto bounded = [](double value) { return cvRound(std::clamp(value, -1e4, 1e4)); };
  return {bounded(m.x()), bounded(m.y())};
}

/// Silhouette of the projected cloud as a mask at a fraction of the image's size: cheap, and closed for any spacing.
cv::Mat silhouette(const ObjectModel& object, const Pose& pose, const CameraModel& camera) {
  const CameraModel small = camera.scaled(1.0 / kShrink);
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

cv::Scalar colorOf(const Annotation& annotation) {
  return annotation.rejected ? rejectedColor() : objectColor(annotation.object);
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

/// A text with the pixels that it covers.
struct Label {
  std::string text;
  double scale;
  int thickness, baseline = 0;
  cv::Rect box;

  Label(const std::string& label, const cv::Size& picture) : text(label), scale(readableTextScale(picture)) {
    thickness = std::max(1, cvRound(1.5 * scale));
    const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, thickness, &baseline);
    box = {0, 0, size.width + 2 * kPadding, size.height + baseline + 2 * kPadding};
  }

  void moveTo(cv::Point corner, const cv::Size& picture) {
    box.x = std::clamp(corner.x, 0, std::max(0, picture.width - box.width));
    box.y = std::clamp(corner.y, 0, std::max(0, picture.height - box.height));
  }

  void draw(cv::Mat& bgr, const cv::Scalar& color) const {
    cv::rectangle(bgr, box, {0, 0, 0}, cv::FILLED);
    cv::putText(bgr, text, {box.x + kPadding, box.br().y - kPadding - baseline}, cv::FONT_HERSHEY_SIMPLEX, scale, color,
                thickness, cv::LINE_AA);
  }
};

cv::Rect shrunk(const cv::Rect& box, const cv::Size& limit) {
  const cv::Point end((box.br().x + kShrink - 1) / kShrink, (box.br().y + kShrink - 1) / kShrink);
  return cv::Rect(box.tl() / kShrink, end) & cv::Rect({}, limit);
}

/// Above, below or beside the object or in its middle, wherever least of `taken` (shrunk) is covered.
void placeLabel(const cv::Rect& object, const cv::Mat& taken, const cv::Size& picture, Label& label) {
  const cv::Size size = label.box.size();
  const cv::Point middle = (object.tl() + object.br()) / 2;
  const int left = middle.x - size.width / 2, top = middle.y - size.height / 2;
  const cv::Point corners[] = {{left, object.y - size.height - kPadding},
                               {left, object.br().y + kPadding},
                               {object.br().x + kPadding, top},
                               {object.x - size.width - kPadding, top},
                               {left, top}};
  int least = std::numeric_limits<int>::max();
  cv::Point best;
  for (const cv::Point& corner : corners) {
    label.moveTo(corner, picture);
    const int covered = cv::countNonZero(taken(shrunk(label.box, taken.size())));
    if (covered < least) least = covered, best = corner;
  }
  label.moveTo(best, picture);
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

double readableTextScale(const cv::Size& picture) {
  int baseline = 0;
  const int height = cv::getTextSize("X", cv::FONT_HERSHEY_SIMPLEX, 1.0, 1, &baseline).height;  // of capitals
  return std::max(kMinTextHeight, kTextHeight * picture.height) / height;
}

cv::Scalar rejectedColor() { return {90, 90, 255}; }

void drawAnnotations(cv::Mat& bgr, const std::vector<Annotation>& annotations, const ModelDatabase& database,
                     const CameraModel& camera) {
  const int width = bgr.cols >= 1000 ? 3 : 2;
  std::vector<cv::Mat> masks;
  for (const Annotation& annotation : annotations) {
    const ObjectModel& object = *database.objects.at(static_cast<size_t>(annotation.object));
    masks.push_back(silhouette(object, annotation.camera_from_object, camera));
    drawOutline(bgr, masks.back(), colorOf(annotation), annotation.rejected ? width - 1 : width);
    if (!annotation.rejected) drawAxes(bgr, annotation.camera_from_object, camera, width);
  }
  cv::Mat labels;
  for (size_t i = 0; i < annotations.size(); ++i) {
    const cv::Rect box = cv::boundingRect(masks[i]);
    if (box.empty()) continue;
    if (labels.empty()) labels = cv::Mat::zeros(masks[i].size(), CV_8UC1);
    cv::Mat taken = labels.clone();
    for (size_t other = 0; other < masks.size(); ++other)
      if (other != i) taken |= masks[other];
    Label label(annotations[i].label, bgr.size());
    placeLabel({box.tl() * kShrink, box.size() * kShrink}, taken, bgr.size(), label);
    label.draw(bgr, colorOf(annotations[i]));
    labels(shrunk(label.box, labels.size())).setTo(255);
  }
}

}  // namespace recognition
