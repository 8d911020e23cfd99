#include "simulation/structured_light.h"

#include <cmath>

namespace recognition {
namespace {

struct Probe {
  float depth = 0.0f;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float signal = 0.0f;
  float glare = 0.0f;
};

Probe probe(const RayScene& scene, const Eigen::Vector3f& eye, const Eigen::Vector3f& projector,
            const Eigen::Vector3f& direction, float pixel_angle) {
  Probe result;
  const SurfaceHit point = scene.cast(eye, direction);
  if (!point.met()) return result;
  result.depth = point.distance;  // directions have z = 1
  result.normal = point.normal;
  const Eigen::Vector3f towards = projector - point.position;
  const float distance = towards.norm();
  const float cosine = point.normal.dot(towards) / distance;
  if (cosine <= 0.0f || scene.blocked(point.position + 5e-4f * point.normal, projector)) return result;
  const BodyAppearance& surface = *scene.scene().bodies[static_cast<size_t>(point.body)].appearance;
  const Finish& finish = surface.finish();
  const float print = surface.albedo(point.triangle, point.weights, 2.0f * pixel_angle * point.distance).maxCoeff();
  const float reflectance = finish.infrared_floor + (1.0f - finish.infrared_floor) * print;
  result.signal = (1.0f - finish.specular) * reflectance * cosine / (distance * distance);
  const Eigen::Vector3f half = (towards / distance - direction.normalized()).normalized();
  result.glare = finish.specular * std::pow(std::max(0.0f, point.normal.dot(half)), finish.shininess);
  return result;
}

}  // namespace

StructuredLightView renderStructuredLight(const RayScene& scene, const CameraModel& camera,
                                          const Pose& world_from_camera, double baseline) {
  camera.validate();
  const cv::Size size(camera.width, camera.height);
  StructuredLightView view{cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC3), cv::Mat(size, CV_32FC1),
                           cv::Mat(size, CV_32FC1)};
  const Eigen::Matrix3f rotation = world_from_camera.linear().cast<float>();
  const Eigen::Vector3f eye = world_from_camera.translation().cast<float>();
  const Eigen::Vector3f projector = (world_from_camera * Eigen::Vector3d(baseline, 0.0, 0.0)).cast<float>();
  cv::parallel_for_(cv::Range(0, camera.height), [&](const cv::Range& rows) {
    for (int v = rows.start; v < rows.end; ++v)
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3f direction = rotation * camera.unproject(u, v, 1.0).cast<float>();
        const Probe p = probe(scene, eye, projector, direction, static_cast<float>(1.0 / camera.fx));
        const Eigen::Vector3f normal = rotation.transpose() * p.normal;
        view.depth.at<float>(v, u) = p.depth;
        view.normals.at<cv::Vec3f>(v, u) = {normal.x(), normal.y(), normal.z()};
        view.signal.at<float>(v, u) = p.signal;
        view.glare.at<float>(v, u) = p.glare;
      }
  });
  return view;
}

}  // namespace recognition
