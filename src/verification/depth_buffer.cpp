#include "rgbd_recognition/verification/depth_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace rgbd_recognition {
namespace {

constexpr float kMinDepth = 0.05f;   // metres; what is nearer is not projected
constexpr float kMinFacing = 0.05f;  // cosine of normal against line of sight
constexpr float kBowl = 0.3f;        // of the disc's radius: how much its rim loses in depth against its centre

/// A point's disc in the camera frame.
struct Disc {
  Eigen::Vector3f centre;
  Eigen::Vector3f normal;
  float u, v;        // projected centre, pixels
  float half_width;  // of the square that holds the disc, pixels
  int point;
};

std::vector<Disc> visibleDiscs(const PreparedModel& model, const Pose& camera_from_object, const CameraModel& camera) {
  const Eigen::Matrix3f rotation = camera_from_object.linear().cast<float>();
  const Eigen::Vector3f translation = camera_from_object.translation().cast<float>();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  std::vector<Disc> discs;
  discs.reserve(model.positions.size() / 2);
  for (size_t i = 0; i < model.positions.size(); ++i) {
    const Eigen::Vector3f p = rotation * model.positions[i] + translation;
    if (p.z() < kMinDepth) continue;
    const Eigen::Vector3f n = rotation * model.normals[i];
    const float facing = -n.dot(p);
    if (facing <= 0.0f || facing * facing < kMinFacing * kMinFacing * p.squaredNorm()) continue;
    const float inverse_z = 1.0f / p.z();
    discs.push_back({p, n, fx * p.x() * inverse_z + cx, fy * p.y() * inverse_z + cy,
                     std::max(fx, fy) * model.point_radius * inverse_z, static_cast<int>(i)});
  }
  return discs;
}

cv::Rect boundingBox(const std::vector<Disc>& discs, const CameraModel& camera) {
  const auto limit = [](float value, int size) { return std::clamp(value, -1.0f, static_cast<float>(size) + 1.0f); };
  float left = 1e9f, top = 1e9f, right = -1e9f, bottom = -1e9f;
  for (const Disc& d : discs) {
    left = std::min(left, d.u - d.half_width);
    right = std::max(right, d.u + d.half_width);
    top = std::min(top, d.v - d.half_width);
    bottom = std::max(bottom, d.v + d.half_width);
  }
  if (discs.empty()) return {};
  const cv::Point first(cvFloor(limit(left, camera.width)), cvFloor(limit(top, camera.height)));
  const cv::Point last(cvCeil(limit(right, camera.width)), cvCeil(limit(bottom, camera.height)));
  return cv::Rect(first, last + cv::Point(1, 1)) & cv::Rect(0, 0, camera.width, camera.height);
}

class DepthBuffer {
 public:
  DepthBuffer(const CameraModel& camera, const cv::Rect& box, float radius, ReprojectedModel* out)
      : box_(box),
        radius_(radius),
        key_(box.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::max())),
        out_(out) {
    out->box = box;
    out->depth = cv::Mat(box.size(), CV_32FC1, cv::Scalar(0));
    out->point = cv::Mat(box.size(), CV_32SC1, cv::Scalar(-1));
    for (int u = box.x; u < box.x + box.width; ++u) ray_x_.push_back(static_cast<float>((u - camera.cx) / camera.fx));
    for (int v = box.y; v < box.y + box.height; ++v) ray_y_.push_back(static_cast<float>((v - camera.cy) / camera.fy));
  }

  void splat(const Disc& d) {
    const int first_u = std::max(cvCeil(d.u - d.half_width), box_.x);
    const int last_u = std::min(cvFloor(d.u + d.half_width), box_.x + box_.width - 1);
    const int first_v = std::max(cvCeil(d.v - d.half_width), box_.y);
    const int last_v = std::min(cvFloor(d.v + d.half_width), box_.y + box_.height - 1);
    const float plane = d.normal.dot(d.centre);
    for (int v = first_v - box_.y; v <= last_v - box_.y; ++v)
      for (int u = first_u - box_.x; u <= last_u - box_.x; ++u)
        put(d, plane, ray_x_[static_cast<size_t>(u)], ray_y_[static_cast<size_t>(v)], u, v);
    putCentre(d);
  }

 private:
  /// The disc's plane seen along the ray (ray_x, ray_y, 1).
  void put(const Disc& d, float plane, float ray_x, float ray_y, int column, int row) {
    const float along = d.normal.x() * ray_x + d.normal.y() * ray_y + d.normal.z();
    if (along > -1e-3f) return;
    const float z = plane / along;
    const float dx = ray_x * z - d.centre.x(), dy = ray_y * z - d.centre.y(), dz = z - d.centre.z();
    const float off = dx * dx + dy * dy + dz * dz;
    if (off > radius_ * radius_) return;
    keep(d, z, z + kBowl * off / radius_, column, row);
  }

  /// Eq. (11): the pixel that the point itself falls on, however small its disc.
  void putCentre(const Disc& d) {
    const int column = cvRound(d.u) - box_.x, row = cvRound(d.v) - box_.y;
    if (column < 0 || row < 0 || column >= box_.width || row >= box_.height) return;
    keep(d, d.centre.z(), d.centre.z() + kBowl * radius_, column, row);
  }

  void keep(const Disc& d, float z, float key, int column, int row) {
    float& best = key_.at<float>(row, column);
    if (key >= best) return;
    int& point = out_->point.at<int>(row, column);
    out_->pixels += point < 0;
    best = key;
    point = d.point;
    out_->depth.at<float>(row, column) = z;
  }

  cv::Rect box_;
  float radius_;
  cv::Mat key_;                       // depth with the bowl on it
  std::vector<float> ray_x_, ray_y_;  // of each column and row of the box
  ReprojectedModel* out_;
};

}  // namespace

ReprojectedModel reproject(const PreparedModel& model, const Pose& camera_from_object, const CameraModel& camera) {
  ReprojectedModel out;
  const std::vector<Disc> discs = visibleDiscs(model, camera_from_object, camera);
  const cv::Rect box = boundingBox(discs, camera);
  if (box.empty()) return out;
  DepthBuffer buffer(camera, box, model.point_radius, &out);
  for (const Disc& disc : discs) buffer.splat(disc);
  if (out.pixels == 0) out = {};
  return out;
}

}  // namespace rgbd_recognition
