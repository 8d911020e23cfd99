#include "simulation/annotate.h"

#include <opencv2/imgproc.hpp>

namespace recognition {

AnnotatedFrame captureAnnotated(const Scene& scene, const std::vector<int>& which, const SimulatedKinect& kinect,
                                std::uint64_t seed, std::uint64_t camera_seed, const Exposure& exposure) {
  const RayScene rays(scene);
  AnnotatedFrame annotated;
  annotated.frame = kinect.capture(rays, seed, camera_seed, exposure);
  const cv::Mat bodies = renderBodies(rays, kinect.colorCamera());
  cv::Mat depth;
  const int k = annotated.frame.colorPerDepthPixel();
  cv::resize(annotated.frame.depth, depth, {}, k, k, cv::INTER_NEAREST);
  const Pose camera_from_world = scene.world_from_camera.inverse();
  for (const int body : which) {
    const SceneBody& b = scene.bodies[static_cast<size_t>(body)];
    AnnotatedObject object;
    object.object_id = b.object_id;
    object.camera_from_object = camera_from_world * b.world_from_body;
    object.visibility = measureVisibility(rays, kinect.colorCamera(), bodies, body);
    object.valid_depth = cv::countNonZero((bodies.rowRange(0, depth.rows) == body) & (depth > 0));
    annotated.objects.push_back(object);
  }
  return annotated;
}

}  // namespace recognition
