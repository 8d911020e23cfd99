#include "alignment/depth_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace recognition {
namespace {

constexpr float kMinDepth = 0.05f;   // metres; what is nearer is not projected
constexpr float kMinFacing = 0.05f;  // cosine of normal against line of sight
constexpr float kBowl = 0.3f;        // of the disc's radius: how much its rim loses in depth against its centre

/// A point's disc as the image sees it: about its centre, the ray meets its plane at a place that is linear in the
/// pixel offset (exact to the second order, and a disc is a few pixels wide).
struct Disc {
  float u, v;                     // projected centre, pixels
  float z, z_by_u, z_by_v;        // metres, and a pixel
  float uu, uv, vv;               // squared distance from the centre along the plane: uu du^2 + 2 uv du dv + vv dv^2
  float half_width, half_height;  // of the ellipse's box, pixels
  int point;
};

/// Projects the points that face the camera. Lines of sight are taken in units of pixels.
class DiscProjector {
 public:
  DiscProjector(const ModelCloud& model, const Pose& camera_from_object, const CameraModel& camera)
      : rotation_(camera_from_object.linear().cast<float>()),
        translation_(camera_from_object.translation().cast<float>()),
        eye_(-rotation_.transpose() * translation_),
        pixel_x_(static_cast<float>(1.0 / camera.fx)),
        pixel_y_(static_cast<float>(1.0 / camera.fy)),
        cx_(static_cast<float>(camera.cx)),
        cy_(static_cast<float>(camera.cy)),
        radius_(model.point_radius) {}

  /// False when the point is too near or turned away.
  bool project(const Eigen::Vector3f& position, const Eigen::Vector3f& normal, Disc* d) const {
    const Eigen::Vector3f to_eye = eye_ - position;
    const float facing = normal.dot(to_eye);
    if (facing <= 0.0f || facing * facing < kMinFacing * kMinFacing * to_eye.squaredNorm()) return false;
    const Eigen::Vector3f p = rotation_ * position + translation_;
    if (p.z() < kMinDepth) return false;
    const Eigen::Vector3f n = rotation_ * normal;
    const Eigen::Vector3f ray = p / p.z();
    d->u = ray.x() / pixel_x_ + cx_;
    d->v = ray.y() / pixel_y_ + cy_;
    d->z = p.z();
    const float slope = p.z() * p.z() / facing;  // of z, over the normal's share in the ray
    d->z_by_u = slope * n.x() * pixel_x_;
    d->z_by_v = slope * n.y() * pixel_y_;
    const Eigen::Vector3f by_u = d->z_by_u * ray + Eigen::Vector3f(p.z() * pixel_x_, 0.0f, 0.0f);
    const Eigen::Vector3f by_v = d->z_by_v * ray + Eigen::Vector3f(0.0f, p.z() * pixel_y_, 0.0f);
    d->uu = by_u.squaredNorm();
    d->uv = by_u.dot(by_v);
    d->vv = by_v.squaredNorm();
    const float scale = radius_ / std::sqrt(std::max(d->uu * d->vv - d->uv * d->uv, 1e-30f));
    d->half_width = scale * std::sqrt(d->vv);
    d->half_height = scale * std::sqrt(d->uu);
    return true;
  }

 private:
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f translation_;
  Eigen::Vector3f eye_;  // the camera's place on the object
  float pixel_x_, pixel_y_, cx_, cy_, radius_;
};

std::vector<Disc> visibleDiscs(const ModelCloud& model, const Pose& camera_from_object, const CameraModel& camera) {
  const DiscProjector projector(model, camera_from_object, camera);
  std::vector<Disc> discs;
  discs.reserve(model.positions.size() / 2);
  Disc disc;
  for (size_t i = 0; i < model.positions.size(); ++i) {
    if (!projector.project(model.positions[i], model.normals[i], &disc)) continue;
    disc.point = static_cast<int>(i);
    discs.push_back(disc);
  }
  return discs;
}

cv::Rect boundingBox(const std::vector<Disc>& discs, const CameraModel& camera) {
  const auto limit = [](float value, int size) { return std::clamp(value, -1.0f, static_cast<float>(size) + 1.0f); };
  float left = 1e9f, top = 1e9f, right = -1e9f, bottom = -1e9f;
  for (const Disc& d : discs) {
    left = std::min(left, d.u - d.half_width);
    right = std::max(right, d.u + d.half_width);
    top = std::min(top, d.v - d.half_height);
    bottom = std::max(bottom, d.v + d.half_height);
  }
  if (discs.empty()) return {};
  const cv::Point first(cvFloor(limit(left, camera.width)), cvFloor(limit(top, camera.height)));
  const cv::Point last(cvCeil(limit(right, camera.width)), cvCeil(limit(bottom, camera.height)));
  return cv::Rect(first, last + cv::Point(1, 1)) & cv::Rect(0, 0, camera.width, camera.height);
}

class DepthBuffer {
 public:
  DepthBuffer(const cv::Rect& box, float radius, ReprojectedModel* out)
      : box_(box),
        radius_(radius),
        key_(box.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::max())),
        out_(out) {
    out->box = box;
    out->depth = cv::Mat(box.size(), CV_32FC1, cv::Scalar(0));
    out->point = cv::Mat(box.size(), CV_32SC1, cv::Scalar(-1));
  }

  void splat(const Disc& d) {
    const float u = d.u - static_cast<float>(box_.x), v = d.v - static_cast<float>(box_.y);
    const int first_u = std::max(cvCeil(u - d.half_width), 0);
    const int last_u = std::min(cvFloor(u + d.half_width), box_.width - 1);
    const int first_v = std::max(cvCeil(v - d.half_height), 0);
    const int last_v = std::min(cvFloor(v + d.half_height), box_.height - 1);
    const float limit = radius_ * radius_, bowl = kBowl / radius_;
    for (int row = first_v; row <= last_v; ++row) {
      const float dv = static_cast<float>(row) - v;
      for (int column = first_u; column <= last_u; ++column) {
        const float du = static_cast<float>(column) - u;
        const float off = du * (d.uu * du + 2.0f * d.uv * dv) + d.vv * dv * dv;
        const float z = d.z + d.z_by_u * du + d.z_by_v * dv;
        if (off <= limit) keep(d.point, z, z + bowl * off, column, row);
      }
    }
    putCentre(d, cvRound(u), cvRound(v));
  }

 private:
  /// Eq. (11): the pixel that the point itself falls on, however small its disc.
  void putCentre(const Disc& d, int column, int row) {
    if (column < 0 || row < 0 || column >= box_.width || row >= box_.height) return;
    keep(d.point, d.z, d.z + kBowl * radius_, column, row);
  }

  void keep(int point, float z, float key, int column, int row) {
    float& best = key_.at<float>(row, column);
    if (key >= best) return;
    best = key;
    out_->point.at<int>(row, column) = point;
    out_->depth.at<float>(row, column) = z;
  }

  cv::Rect box_;
  float radius_;
  cv::Mat key_;  // depth with the bowl on it
  ReprojectedModel* out_;
};

/// A coarse depth buffer of points alone, in cells of some pixels.
class CellBuffer {
 public:
  CellBuffer(const CameraModel& camera, float cell) : cell_(cell), columns_(cvCeil(camera.width / cell) + 1) {
    const int rows = cvCeil(camera.height / cell) + 1;
    nearest_.assign(static_cast<size_t>(columns_ * rows), std::numeric_limits<float>::max());
    width_ = static_cast<float>(camera.width);
    height_ = static_cast<float>(camera.height);
  }
  bool holds(const Disc& d) const { return d.u >= 0.0f && d.v >= 0.0f && d.u < width_ && d.v < height_; }
  float& nearest(const Disc& d) {
    return nearest_[static_cast<size_t>(static_cast<int>(d.v / cell_) * columns_ + static_cast<int>(d.u / cell_))];
  }

 private:
  float cell_, width_, height_;
  int columns_;
  std::vector<float> nearest_;
};

}  // namespace

std::vector<int> visiblePoints(const PreparedModel& model, const Pose& camera_from_object, const CameraModel& camera,
                               size_t candidates) {
  const size_t step = std::max<size_t>(1, model.positions.size() / candidates);
  const float z = static_cast<float>((camera_from_object * model.centre.cast<double>()).z());
  if (z < kMinDepth) return {};
  const float spacing = 2.0f * model.point_radius * std::sqrt(static_cast<float>(step));  // metres, of the candidates
  CellBuffer buffer(camera, std::max(2.0f, spacing * static_cast<float>(camera.fx) / z));
  const DiscProjector projector(model, camera_from_object, camera);
  std::vector<Disc> discs;
  Disc disc;
  for (size_t i = 0; i < model.positions.size(); i += step) {
    if (!projector.project(model.positions[i], model.normals[i], &disc) || !buffer.holds(disc)) continue;
    disc.point = static_cast<int>(i);
    discs.push_back(disc);
    float& nearest = buffer.nearest(disc);
    nearest = std::min(nearest, disc.z);
  }
  std::vector<int> points;
  for (const Disc& d : discs)
    if (d.z <= buffer.nearest(d) + 2.0f * spacing) points.push_back(d.point);
  return points;
}

ReprojectedModel reproject(const ModelCloud& model, const Pose& camera_from_object, const CameraModel& camera) {
  ReprojectedModel out;
  const std::vector<Disc> discs = visibleDiscs(model, camera_from_object, camera);
  const cv::Rect box = boundingBox(discs, camera);
  if (box.empty()) return out;
  DepthBuffer buffer(box, model.point_radius, &out);
  for (const Disc& disc : discs) buffer.splat(disc);
  out.pixels = cv::countNonZero(out.point >= 0);
  if (out.pixels == 0) out = {};
  return out;
}

}  // namespace recognition
