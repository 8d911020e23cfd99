#include "segmentation/analytic_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

struct Hit {
  double t = kFar;
  int face = 0;
};

void keepNearer(double t, int face, Hit* hit) {
  if (t > 1e-6 && t < hit->t) *hit = {t, face};
}

Hit hitBox(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, const Eigen::Vector3d& half) {
  Hit hit;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const double t = ((side ? half[axis] : -half[axis]) - origin[axis]) / ray[axis];
      const Eigen::Vector3d p = origin + t * ray;
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      if (std::abs(p[b]) <= half[b] && std::abs(p[c]) <= half[c]) keepNearer(t, 2 * axis + side, &hit);
    }
  }
  return hit;
}

/// Roots of a t^2 + 2 b t + c.
void keepRoots(double a, double b, double c, const Eigen::Vector3d& origin, const Eigen::Vector3d& ray,
               double half_height, Hit* hit) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) return;
  for (const double t : {(-b - std::sqrt(discriminant)) / a, (-b + std::sqrt(discriminant)) / a})
    if (std::abs(origin.z() + t * ray.z()) <= half_height) keepNearer(t, 0, hit);
}

Hit hitCylinder(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, const Eigen::Vector3d& half) {
  Hit hit;
  const Eigen::Vector2d o = origin.head<2>(), r = ray.head<2>();
  keepRoots(r.squaredNorm(), o.dot(r), o.squaredNorm() - half.x() * half.x(), origin, ray, half.z(), &hit);
  for (int cap = 0; cap < 2; ++cap) {
    const double t = ((cap ? half.z() : -half.z()) - origin.z()) / ray.z();
    if ((o + t * r).norm() <= half.x()) keepNearer(t, 1 + cap, &hit);
  }
  return hit;
}

Hit hitSphere(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, const Eigen::Vector3d& half) {
  Hit hit;
  keepRoots(ray.squaredNorm(), origin.dot(ray), origin.squaredNorm() - half.x() * half.x(), origin, ray, kFar, &hit);
  return hit;
}

/// Noise of standard deviation `sigma` that varies over `window` pixels.
cv::Mat correlatedNoise(cv::Size size, double sigma, int window, cv::RNG* rng) {
  cv::Mat noise(size, CV_32FC1);
  rng->fill(noise, cv::RNG::NORMAL, 0.0, sigma * window);
  cv::blur(noise, noise, {window, window});
  return noise;
}

}  // namespace

int AnalyticScene::add(const Body& body) {
  bodies_.push_back(body);
  return static_cast<int>(bodies_.size()) - 1;
}

int AnalyticScene::addSphere(const Eigen::Vector3d& centre, double radius) {
  return add({Shape::kSphere, Pose(Eigen::Translation3d(centre)), Eigen::Vector3d::Constant(radius)});
}

AnalyticScene::View AnalyticScene::render(const CameraModel& camera) const {
  const cv::Size size(camera.width, camera.height);
  View view{cv::Mat(size, CV_32FC1, cv::Scalar(0)), cv::Mat(size, CV_32SC1, cv::Scalar(-1)),
            cv::Mat(size, CV_32SC1, cv::Scalar(-1))};
  cv::Mat nearest(size, CV_64FC1, cv::Scalar(kFar));
  for (size_t i = 0; i < bodies_.size(); ++i) {
    const Body& body = bodies_[i];
    const Pose body_from_camera = body.camera_from_body.inverse();
    const Eigen::Vector3d origin = body_from_camera.translation();
    for (int v = 0; v < size.height; ++v) {
      for (int u = 0; u < size.width; ++u) {
        const Eigen::Vector3d ray = body_from_camera.linear() * camera.unproject(u, v, 1.0);
        Hit hit;
        if (body.shape == Shape::kPlane) keepNearer(-origin.z() / ray.z(), 0, &hit);
        if (body.shape == Shape::kBox) hit = hitBox(origin, ray, body.half);
        if (body.shape == Shape::kCylinder) hit = hitCylinder(origin, ray, body.half);
        if (body.shape == Shape::kSphere) hit = hitSphere(origin, ray, body.half);
        if (!(hit.t < nearest.at<double>(v, u))) continue;
        nearest.at<double>(v, u) = hit.t;
        view.depth.at<float>(v, u) = static_cast<float>(hit.t);  // the ray's z is 1
        view.object.at<int>(v, u) = static_cast<int>(i);
        view.face.at<int>(v, u) = hit.face;
      }
    }
  }
  return view;
}

cv::Mat kinectDepth(const cv::Mat& depth, const CameraModel& camera, std::uint64_t seed, double lateral,
                    double distortion) {
  constexpr double kUnit = 2.85e-3;  // of 1/z, a disparity unit
  constexpr double kBaseline = 0.075;
  cv::RNG rng(seed);
  const cv::Mat matching = correlatedNoise(depth.size(), 0.5 * kUnit, 3, &rng);
  const cv::Mat shift_u = correlatedNoise(depth.size(), lateral, 3, &rng),
                shift_v = correlatedNoise(depth.size(), lateral, 3, &rng);
  const double phase_u = rng.uniform(0.0, 6.0), phase_v = rng.uniform(0.0, 6.0);
  cv::Mat seen(depth.size(), CV_32FC1, cv::Scalar(0));
  for (int v = 0; v < depth.rows; ++v) {
    double reach = -kFar;  // rightmost projector column that is lit, from the left
    for (int u = 0; u < depth.cols; ++u) {
      const int from_u = std::clamp(cvRound(u + shift_u.at<float>(v, u)), 0, depth.cols - 1);
      const int from_v = std::clamp(cvRound(v + shift_v.at<float>(v, u)), 0, depth.rows - 1);
      const double z = depth.at<float>(from_v, from_u);
      if (z <= 0.0) continue;
      const double projector = u - camera.fx * kBaseline / z;
      if (projector < reach - 2.0) continue;  // shadow
      reach = std::max(reach, projector);
      const double wave = distortion * std::sin(phase_u + 0.011 * u) * std::cos(phase_v + 0.009 * v);
      const double disparity = std::round((1.0 / z + wave + matching.at<float>(v, u)) / kUnit);
      if (disparity > 0.0) seen.at<float>(v, u) = static_cast<float>(1.0 / (disparity * kUnit));
    }
  }
  return seen;
}

AnalyticScene randomTableScene(std::uint64_t seed, int count) {
  cv::RNG rng(seed);
  const double tilt = rng.uniform(0.5, 1.0), range = rng.uniform(0.7, 1.3);
  Pose camera_from_table = Pose::Identity();  // table: z up, x right
  camera_from_table.translate(Eigen::Vector3d(0.0, 0.0, range));
  camera_from_table.rotate(Eigen::AngleAxisd(M_PI / 2.0 + tilt, Eigen::Vector3d::UnitX()));
  AnalyticScene scene;
  scene.addPlane(camera_from_table);
  for (int i = 0; i < count; ++i) {
    Pose pose = camera_from_table;
    const double height = rng.uniform(0.06, 0.25);
    const int kind = rng.uniform(0, 3);
    const double radius = rng.uniform(0.03, 0.06);
    const double lift = kind == 2 ? radius : 0.5 * height;
    pose.translate(Eigen::Vector3d(rng.uniform(-0.3, 0.3), rng.uniform(-0.25, 0.25), lift));
    pose.rotate(Eigen::AngleAxisd(rng.uniform(0.0, M_PI), Eigen::Vector3d::UnitZ()));
    if (kind == 0) scene.addBox(pose, {rng.uniform(0.04, 0.2), rng.uniform(0.04, 0.2), height});
    if (kind == 1) scene.addCylinder(pose, radius, height);
    if (kind == 2) scene.addSphere(pose.translation(), radius);
  }
  return scene;
}

}  // namespace recognition
