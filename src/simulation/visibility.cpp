#include "simulation/visibility.h"

#include <cmath>

namespace recognition {
namespace {

class Viewer {
 public:
  Viewer(const RayScene& scene, const CameraModel& camera) : camera_(camera) {
    const Pose& pose = scene.scene().world_from_camera;
    rotation_ = pose.linear().cast<float>();
    eye = pose.translation().cast<float>();
  }

  Eigen::Vector3f direction(int u, int v) const { return rotation_ * camera_.unproject(u, v, 1.0).cast<float>(); }

  Eigen::Vector3f eye;

 private:
  const CameraModel& camera_;
  Eigen::Matrix3f rotation_;
};

// Pixels that may see the body; empty if part of it is behind the camera.
cv::Rect projectedBox(const RayScene& scene, const CameraModel& camera, int body) {
  const SceneBody& b = scene.scene().bodies[static_cast<size_t>(body)];
  const Pose camera_from_body = scene.scene().world_from_camera.inverse() * b.world_from_body;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3f& vertex : b.appearance->mesh().vertices) {
    const Eigen::Vector3d point = camera_from_body * vertex.cast<double>();
    if (point.z() < 0.05) return {};
    box.extend(camera.project(point));
  }
  const cv::Point first(static_cast<int>(std::floor(box.min().x())), static_cast<int>(std::floor(box.min().y())));
  const cv::Point last(static_cast<int>(std::ceil(box.max().x())), static_cast<int>(std::ceil(box.max().y())));
  return {first, last + cv::Point(1, 1)};
}

void extend(cv::Rect& box, int u, int v) { box = box.empty() ? cv::Rect(u, v, 1, 1) : box | cv::Rect(u, v, 1, 1); }

}  // namespace

cv::Mat renderBodies(const RayScene& scene, const CameraModel& camera) {
  camera.validate();
  cv::Mat bodies(camera.height, camera.width, CV_32SC1);
  const Viewer viewer(scene, camera);
  cv::parallel_for_(cv::Range(0, camera.height), [&](const cv::Range& rows) {
    for (int v = rows.start; v < rows.end; ++v)
      for (int u = 0; u < camera.width; ++u) bodies.at<int>(v, u) = scene.cast(viewer.eye, viewer.direction(u, v)).body;
  });
  return bodies;
}

BodyVisibility measureVisibility(const RayScene& scene, const CameraModel& camera, const cv::Mat& bodies, int body) {
  BodyVisibility visibility;
  const cv::Rect area = projectedBox(scene, camera, body);
  const cv::Rect image({}, bodies.size());
  const Viewer viewer(scene, camera);
  for (int v = area.y; v < area.br().y; ++v)
    for (int u = area.x; u < area.br().x; ++u) {
      if (!scene.meetsAlone(body, viewer.eye, viewer.direction(u, v))) continue;
      ++visibility.all;
      extend(visibility.box_all, u, v);
      if (!image.contains({u, v}) || bodies.at<int>(v, u) != body) continue;
      ++visibility.visible;
      extend(visibility.box_visible, u, v);
    }
  return visibility;
}

}  // namespace recognition
