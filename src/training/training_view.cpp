#include "training/training_view.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/angles.h"
#include "meshes/surface_sampling.h"
#include "meshes/surface_orientation.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

constexpr int kImageMargin = 16;             // pixels around the object
constexpr double kNearestInDiameters = 1.3;  // a camera nearer than this would not have the whole object in view
constexpr float kDepthJump = 0.01f;          // metres between neighbouring pixels: an outline inside the object

Pose lookFrom(const Eigen::Vector3d& direction, double distance, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d z = -direction;
  const Eigen::Vector3d x =
      z.cross(std::abs(z.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX()).normalized();
  Pose camera_from_object = Pose::Identity();
  camera_from_object.linear().row(0) = x;
  camera_from_object.linear().row(1) = z.cross(x);
  camera_from_object.linear().row(2) = z;
  camera_from_object.translation() = -camera_from_object.linear() * (centre + distance * direction);
  return camera_from_object;
}

CameraModel cutToObject(const TexturedMesh& mesh, const Pose& camera_from_object, double focal_length) {
  const CameraModel whole{1, 1, focal_length, focal_length, 0.0, 0.0};
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    box.extend(whole.project(camera_from_object * vertex.cast<double>()));
  const Eigen::Vector2d origin = box.min().array().floor() - kImageMargin;
  const Eigen::Vector2d size = (box.max() - origin).array().ceil() + kImageMargin;
  return {static_cast<int>(size.x()), static_cast<int>(size.y()), focal_length, focal_length, -origin.x(), -origin.y()};
}

// 0 on outlines and jumps, 255 elsewhere.
cv::Mat awayFromOutlines(const cv::Mat& depth) {
  cv::Mat highest, lowest;
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, cv::Size(3, 3));
  cv::dilate(depth, highest, cross);
  cv::erode(depth, lowest, cross);
  return highest - lowest < kDepthJump;
}

cv::Mat grayOnMeanBackground(const RenderedView& rendered, const cv::Mat& mask, double blur) {
  cv::Mat gray = toGray(rendered.color, ColorOrder::kBgr);
  gray.setTo(cv::mean(gray, mask), mask == 0);
  if (blur > 0.0) cv::GaussianBlur(gray, gray, cv::Size(), blur);
  return gray;
}

}  // namespace

std::vector<TrainingCamera> placeTrainingCameras(const TexturedMesh& mesh, const TrainingParameters& parameters) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
  const Eigen::Vector3d centre = box.center().cast<double>();
  const double nearest = kNearestInDiameters * box.diagonal().norm();
  const double step = parameters.distances > 1 ? std::pow(parameters.far_distance / parameters.near_distance,
                                                          1.0 / (parameters.distances - 1))
                                               : 1.0;
  std::vector<TrainingCamera> cameras;
  for (int i = 0; i < parameters.distances; ++i) {
    const double distance = std::max(nearest, parameters.near_distance) * std::pow(step, i);
    for (const Eigen::Vector3f& direction : sphereDirections(parameters.views)) {
      const Pose pose = lookFrom(direction.cast<double>(), distance, centre);
      cameras.push_back({cutToObject(mesh, pose, parameters.focal_length), pose});
    }
  }
  return cameras;
}

TrainingView renderTrainingView(const MeshRenderer& renderer, const TrainingCamera& from,
                                const TrainingParameters& parameters) {
  const RenderedView rendered = renderer.render(from.camera, 1, from.camera_from_object);
  TrainingView view{from, {}, rendered.depth > 0.0, {}};
  view.gray = grayOnMeanBackground(rendered, view.mask, parameters.blur);
  cv::distanceTransform(awayFromOutlines(rendered.depth) & view.mask, view.outline_distance, cv::DIST_L2, 3);
  return view;
}

ModelFeatures placeOnSurface(const ImageFeatures& features, const TrainingView& view, const MeshRenderer& renderer,
                             const TrainingParameters& parameters) {
  const Pose object_from_camera = view.from.camera_from_object.inverse();
  const Eigen::Vector3f camera_place = object_from_camera.translation().cast<float>();
  const auto min_cosine = static_cast<float>(std::cos(parameters.largest_slant * kPi / 180.0));
  ModelFeatures placed;
  for (int i = 0; i < features.count(); ++i) {
    const Keypoint& keypoint = features.keypoints[static_cast<size_t>(i)];
    const float outline = view.outline_distance.at<float>(std::clamp(cvRound(keypoint.y), 0, view.gray.rows - 1),
                                                          std::clamp(cvRound(keypoint.x), 0, view.gray.cols - 1));
    if (outline < static_cast<float>(parameters.outline_margin) * keypoint.size) continue;
    const Eigen::Vector3d ray = view.from.camera.unproject(keypoint.x, keypoint.y, 1.0);
    const Eigen::Vector3f direction =
        (object_from_camera.linear() * ray).cast<float>();  // length along the optical axis is 1
    const RayHit hit = renderer.cast(camera_place, direction, 0.0f);
    if (!hit.hit() || -hit.normal.dot(direction.normalized()) < min_cosine) continue;
    placed.descriptors.push_back(features.descriptors.row(i));
    placed.positions.push_back(camera_place + hit.distance * direction);
    placed.view_directions.push_back(-direction.normalized());
    placed.orientations.push_back(
        surfaceOrientation(keypoint.angle, placed.view_directions.back(), object_from_camera));
    placed.sizes.push_back(keypoint.size * hit.distance / static_cast<float>(view.from.camera.fx));
    placed.views.push_back(1);
  }
  return placed;
}

}  // namespace recognition
