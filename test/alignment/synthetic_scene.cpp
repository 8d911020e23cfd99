#include "alignment/synthetic_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Dense>

#include "core/depth_noise.h"
#include "alignment/scene_view.h"

namespace recognition::synthetic {
namespace {

constexpr double kWall = 1.6;
constexpr double kSpacing = 0.002;

std::uint32_t hash(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}

double intersectBox(const Eigen::Vector3d& half, const Eigen::Vector3d& o, const Eigen::Vector3d& d,
                    Eigen::Vector3d* normal) {
  double enter = -std::numeric_limits<double>::max(), leave = std::numeric_limits<double>::max();
  for (int i = 0; i < 3; ++i) {
    if (std::abs(d[i]) < 1e-12 && std::abs(o[i]) > half[i]) return -1.0;
    const double first = (-std::copysign(half[i], d[i]) - o[i]) / d[i],
                 last = (std::copysign(half[i], d[i]) - o[i]) / d[i];
    if (first > enter) {
      enter = first;
      *normal = -std::copysign(1.0, d[i]) * Eigen::Vector3d::Unit(i);
    }
    leave = std::min(leave, last);
  }
  return enter < leave ? enter : -1.0;
}

double intersectCan(const Eigen::Vector3d& half, const Eigen::Vector3d& o, const Eigen::Vector3d& d,
                    Eigen::Vector3d* normal) {
  double best = -1.0;
  const double a = d.x() * d.x() + d.z() * d.z(), b = o.x() * d.x() + o.z() * d.z();
  const double root = b * b - a * (o.x() * o.x() + o.z() * o.z() - half.x() * half.x());
  if (root >= 0.0) {
    const double t = (-b - std::sqrt(root)) / a;
    const Eigen::Vector3d p = o + t * d;
    if (std::abs(p.y()) <= half.y()) {
      best = t;
      *normal = Eigen::Vector3d(p.x(), 0.0, p.z()).normalized();
    }
  }
  const double lid = (-std::copysign(half.y(), d.y()) - o.y()) / d.y();
  const Eigen::Vector3d p = o + lid * d;
  if (std::hypot(p.x(), p.z()) <= half.x() && (best < 0.0 || lid < best)) {
    best = lid;
    *normal = Eigen::Vector3d(0.0, -std::copysign(1.0, d.y()), 0.0);
  }
  return best;
}

/// Nearest hit of the ray (camera frame, z of `ray` is 1, so the distance is the depth).
struct Hit {
  int instance = -1;
  double depth = kWall;
  cv::Vec3b rgb = {120, 120, 110};
};

Hit castRay(const std::vector<Placed>& placed, const Eigen::Vector3d& ray) {
  Hit hit;
  for (size_t i = 0; i < placed.size(); ++i) {
    const Pose object_from_camera = placed[i].camera_from_object.inverse();
    const Eigen::Vector3d origin = object_from_camera.translation(), direction = object_from_camera.linear() * ray;
    Eigen::Vector3d normal;
    const double t = placed[i].solid.intersect(origin, direction, &normal);
    if (t <= 0.0 || t >= hit.depth) continue;
    hit = {static_cast<int>(i), t, placed[i].solid.texture(origin + t * direction)};
  }
  return hit;
}

void renderImages(const std::vector<Placed>& placed, const Sensor& sensor, Scene* scene) {
  const CameraModel& camera = sensor.camera;
  std::mt19937 random(sensor.seed);
  std::normal_distribution<double> normal;
  scene->frame.color = cv::Mat(camera.height, camera.width, CV_8UC3);
  scene->depth = cv::Mat(camera.height, camera.width, CV_32FC1);
  scene->instance = cv::Mat(camera.height, camera.width, CV_32SC1);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Hit hit = castRay(placed, camera.unproject(u, v, 1.0));
      scene->instance.at<int>(v, u) = hit.instance;
      scene->depth.at<float>(v, u) = static_cast<float>(sensor.depth_scale * hit.depth +
                                                        sensor.depth_noise * depthSigma(hit.depth) * normal(random));
      for (int c = 0; c < 3; ++c)
        scene->frame.color.at<cv::Vec3b>(v, u)[2 - c] = cv::saturate_cast<std::uint8_t>(
            sensor.gain * hit.rgb[c] + sensor.offset + sensor.color_noise * normal(random));
    }
  }
  scene->frame.depth = scene->depth;
  scene->frame.color_camera = camera;
}

void segment(size_t solids, Scene* scene) {
  scene->segmentation.labels = scene->instance + 1;
  scene->segmentation.edges = cv::Mat(scene->instance.size(), CV_8UC1, cv::Scalar(0));
  for (int v = 0; v < scene->instance.rows; ++v)
    for (int u = 1; u < scene->instance.cols; ++u)
      if (scene->instance.at<int>(v, u) != scene->instance.at<int>(v, u - 1))
        scene->segmentation.edges.at<EdgeType>(v, u) = EdgeType::kJump;
  for (int label = 1; label <= static_cast<int>(solids); ++label) {
    Patch patch;
    patch.label = label;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (int v = 0; v < scene->depth.rows; ++v)
      for (int u = 0; u < scene->depth.cols; ++u) {
        if (scene->segmentation.labels.at<int>(v, u) != label) continue;
        const Eigen::Vector3d p = scene->frame.color_camera.unproject(u, v, scene->depth.at<float>(v, u));
        sum += p;
        squares += p * p.transpose();
        ++patch.pixels;
      }
    const double pixels = std::max(1, patch.pixels);
    const Eigen::Vector3d mean = sum / pixels;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / pixels - mean * mean.transpose());
    patch.centroid = mean.cast<float>();
    patch.eigenvalues = solver.eigenvalues().cwiseMax(0.0).cast<float>();
    patch.axes = solver.eigenvectors().cast<float>();
    scene->segmentation.patches.push_back(patch);
  }
}

void addFeatures(const std::vector<Placed>& placed, const std::vector<ObjectModel>& models, const Sensor& sensor,
                 Scene* scene) {
  std::mt19937 random(sensor.seed + 1);
  std::normal_distribution<double> normal;
  for (size_t i = 0; i < placed.size(); ++i) {
    Hypothesis truth;
    truth.object = static_cast<int>(i);
    truth.camera_from_object = placed[i].camera_from_object;
    const ModelFeatures& features = models[i].features.at(DescriptorType::kSurf128);
    for (int f = 0; f < features.count(); ++f) {
      const Eigen::Vector3d p =
          placed[i].camera_from_object * features.positions[static_cast<size_t>(f)].cast<double>();
      const Eigen::Vector2d pixel = sensor.camera.project(p);
      const int u = cvRound(pixel.x()), v = cvRound(pixel.y());
      if (u < 0 || v < 0 || u >= sensor.camera.width || v >= sensor.camera.height) continue;
      if (scene->instance.at<int>(v, u) != static_cast<int>(i) ||
          std::abs(scene->depth.at<float>(v, u) - sensor.depth_scale * p.z()) > 0.01)
        continue;
      Keypoint keypoint;
      keypoint.x = static_cast<float>(pixel.x() + sensor.keypoint_noise * normal(random));
      keypoint.y = static_cast<float>(pixel.y() + sensor.keypoint_noise * normal(random));
      truth.consensus.push_back({static_cast<int>(scene->features.points.size()), f, 0.1f});
      keypoint.size = static_cast<float>(0.01 * sensor.camera.fx / scene->depth.at<float>(v, u));  // as the model's
      scene->features.image.keypoints.push_back(keypoint);
      scene->features.image.descriptors.push_back(cv::Mat(1, 128, CV_32FC1, cv::Scalar(std::sqrt(1.0 / 128.0))));
      scene->features.points.push_back(
          sensor.camera.unproject(keypoint.x, keypoint.y, scene->depth.at<float>(v, u)).cast<float>());
    }
    scene->truth.push_back(truth);
  }
}

}  // namespace

double Solid::intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                        Eigen::Vector3d* normal) const {
  return shape == Shape::kBox ? intersectBox(half, origin, direction, normal)
                              : intersectCan(half, origin, direction, normal);
}

std::function<cv::Vec3b(const Eigen::Vector3d&)> patchwork(std::uint32_t seed) {
  return [seed](const Eigen::Vector3d& p) {
    const Eigen::Vector3i cell = (p / 0.011 + Eigen::Vector3d::Constant(100.37)).array().floor().cast<int>();
    const std::uint32_t h =
        hash(hash(hash(hash(seed) + static_cast<std::uint32_t>(cell.x())) + static_cast<std::uint32_t>(cell.y())) +
             static_cast<std::uint32_t>(cell.z()));
    return cv::Vec3b(static_cast<std::uint8_t>(30 + h % 180), static_cast<std::uint8_t>(30 + (h >> 8) % 180),
                     static_cast<std::uint8_t>(30 + (h >> 16) % 180));
  };
}

Solid box(std::uint32_t seed) { return {Solid::Shape::kBox, {0.05, 0.08, 0.03}, patchwork(seed)}; }
Solid can(std::uint32_t seed) { return {Solid::Shape::kCan, {0.035, 0.055, 0.035}, patchwork(seed)}; }

ObjectModel makeModel(const Solid& solid, const std::string& name, int features) {
  ObjectModel model;
  model.name = name;
  // Rays from outside along the axes, on a grid, and for a can also towards its axis.
  const auto addRay = [&](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
    Eigen::Vector3d normal;
    const double t = solid.intersect(origin, direction, &normal);
    if (t <= 0.0) return;
    const Eigen::Vector3d p = origin + t * direction;
    if (normal.dot(-direction) > 0.99)
      model.cloud.push_back({p.cast<float>(), normal.cast<float>(), solid.texture(p - 1e-6 * normal)});
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    if (solid.shape == Solid::Shape::kCan && axis != 1) continue;
    for (const double side : {-1.0, 1.0})
      for (double x = -solid.half[a] + kSpacing / 2; x < solid.half[a]; x += kSpacing)
        for (double y = -solid.half[b] + kSpacing / 2; y < solid.half[b]; y += kSpacing)
          addRay(side * Eigen::Vector3d::Unit(axis) + x * Eigen::Vector3d::Unit(a) + y * Eigen::Vector3d::Unit(b),
                 -side * Eigen::Vector3d::Unit(axis));
  }
  if (solid.shape == Solid::Shape::kCan)
    for (double angle = 0.0; angle < 2.0 * M_PI; angle += kSpacing / solid.half.x())
      for (double y = -solid.half.y() + kSpacing / 2; y < solid.half.y(); y += kSpacing)
        addRay({std::sin(angle), y, std::cos(angle)}, {-std::sin(angle), 0.0, -std::cos(angle)});

  std::mt19937 random(static_cast<std::uint32_t>(features));
  ModelFeatures& own = model.features[DescriptorType::kSurf128];
  own.descriptors = cv::Mat(features, 128, CV_32FC1, cv::Scalar(std::sqrt(1.0 / 128.0)));
  for (int i = 0; i < features; ++i) {
    const SurfacePoint& point = model.cloud[random() % model.cloud.size()];
    own.positions.push_back(point.position);
    own.view_directions.push_back(point.normal);
    own.sizes.push_back(0.01f);
    own.views.push_back(1);
  }
  model.extents = computeExtents(model.cloud);
  return model;
}

std::unique_ptr<Scene> render(const std::vector<Placed>& placed, const std::vector<ObjectModel>& models,
                              const Sensor& sensor) {
  auto scene = std::make_unique<Scene>();
  renderImages(placed, sensor, scene.get());
  segment(placed.size(), scene.get());
  addFeatures(placed, models, sensor, scene.get());
  scene->view = SceneView::make(scene->frame, scene->depth, scene->segmentation, scene->features);
  return scene;
}

Pose poseAt(const Eigen::Vector3d& position, double degrees, const Eigen::Vector3d& axis) {
  Pose pose = Pose::Identity();
  pose.translation() = position;
  pose.linear() = (Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(degrees * M_PI / 180.0, axis.normalized()))
                      .toRotationMatrix();
  return pose;
}

Pose disturbed(const Pose& pose, double metres, double degrees, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized().eval();
  };
  Pose out = pose;
  out.translation() += metres * direction();
  out.linear() = Eigen::AngleAxisd(degrees * M_PI / 180.0, direction()).toRotationMatrix() * out.linear();
  return out;
}

ModelDatabase databaseOf(const std::vector<ObjectModel>& models) {
  ModelDatabase database;
  for (const ObjectModel& model : models) database.objects.push_back(std::make_shared<const ObjectModel>(model));
  return database;
}

}  // namespace recognition::synthetic
