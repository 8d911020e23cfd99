#include "tracking/scene_crop.h"

#include <algorithm>
#include <cmath>

namespace recognition {
namespace {

constexpr double kMinDepth = 0.05;  // metres
constexpr int kOutlinePoints = 400;
constexpr int kMinSide = 16;  // pixels

RgbdFrame part(const RgbdFrame& frame, const cv::Rect& box) {
  const int k = frame.colorPerDepthPixel();
  const cv::Rect in_color(box.x * k, box.y * k, box.width * k, box.height * k);
  RgbdFrame out;
  out.color = frame.color(in_color);
  out.color_order = frame.color_order;
  out.depth = frame.depth(box);
  out.color_camera = frame.color_camera;
  out.color_camera.cx -= in_color.x;
  out.color_camera.cy -= in_color.y;
  out.color_camera.width = in_color.width;
  out.color_camera.height = in_color.height;
  return out;
}

int evenBelow(double value) { return 2 * cvFloor(0.5 * value); }

}  // namespace

SceneCrop::SceneCrop(const RgbdFrame& frame, const cv::Rect& box) : box_(box) {
  segmentation_.labels = cv::Mat::zeros(box.size(), CV_32SC1);
  segmentation_.edges = cv::Mat::zeros(box.size(), CV_8UC1);
  const RgbdFrame own = part(frame, box);
  view_ = SceneView::make(own, depthInMetres(own.depth), segmentation_, features_);
}

cv::Rect modelBox(const PreparedModel& model, const Pose& camera_from_object, const CameraModel& depth_camera,
                  int margin) {
  const ProbePoints& points = model.probe_points;
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
  for (int i = 0; i < std::min(kOutlinePoints, points.count()); ++i) {
    const auto k = static_cast<size_t>(i);
    const Eigen::Vector3d p =
        camera_from_object * Eigen::Vector3d(points.position[0][k], points.position[1][k], points.position[2][k]);
    if (p.z() < kMinDepth) continue;
    const Eigen::Vector2d pixel = depth_camera.project(p);
    left = std::min(left, pixel.x()), right = std::max(right, pixel.x());
    top = std::min(top, pixel.y()), bottom = std::max(bottom, pixel.y());
  }
  const double width = depth_camera.width, height = depth_camera.height;
  if (right < 0.0 || bottom < 0.0 || left >= width || top >= height) return {};
  const int first_u = evenBelow(std::max(0.0, left - margin)), first_v = evenBelow(std::max(0.0, top - margin));
  const int last_u = evenBelow(std::min(width, right + margin + 2.0));
  const int last_v = evenBelow(std::min(height, bottom + margin + 2.0));
  if (last_u - first_u < kMinSide || last_v - first_v < kMinSide) return {};
  return {first_u, first_v, last_u - first_u, last_v - first_v};
}

}  // namespace recognition
