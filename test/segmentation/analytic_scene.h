#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/pose.h"

namespace recognition {

/// Scenes of analytic surfaces, ray-cast: depth and surfaces are known exactly.
class AnalyticScene {
 public:
  enum class Shape { kPlane, kBox, kCylinder, kSphere };

  /// Plane through the pose's origin with its z axis as normal, infinite.
  int addPlane(const Pose& camera_from_plane) {
    return add({Shape::kPlane, camera_from_plane, Eigen::Vector3d::Zero()});
  }
  /// Box of full side lengths `size`, centred in the pose.
  int addBox(const Pose& camera_from_box, const Eigen::Vector3d& size) {
    return add({Shape::kBox, camera_from_box, 0.5 * size});
  }
  /// Closed cylinder along the pose's z axis.
  int addCylinder(const Pose& camera_from_cylinder, double radius, double height) {
    return add({Shape::kCylinder, camera_from_cylinder, {radius, radius, 0.5 * height}});
  }
  int addSphere(const Eigen::Vector3d& centre, double radius);

  /// Truth by pixel.
  struct View {
    cv::Mat depth;   ///< CV_32FC1 metres, 0 where nothing is hit
    cv::Mat object;  ///< CV_32SC1 number as returned by add...(), -1 where nothing is hit
    cv::Mat face;    ///< CV_32SC1 smooth face of the object (box: 0-5, cylinder: 0 side, 1-2 caps)
  };
  View render(const CameraModel& camera) const;

 private:
  struct Body {
    Shape shape;
    Pose camera_from_body;
    Eigen::Vector3d half;
  };
  int add(const Body& body);

  std::vector<Body> bodies_;
};

/// What a structured-light sensor makes of true depth: matching noise of half a disparity unit, correlated over the
/// matching window, lateral jitter of `lateral` pixels at slanted surfaces and outlines, quantisation to disparity
/// units (Khoshelham and Elberink 2012), the projector's shadow as holes, and a smooth distortion of `distortion`
/// metres at 1 m. Seeded.
cv::Mat kinectDepth(const cv::Mat& depth, const CameraModel& camera, std::uint64_t seed, double lateral = 0.5,
                    double distortion = 0.0);

/// A table seen from above at random range and tilt with `count` boxes, cylinders and spheres standing on it, some
/// touching. Object 0 is the table.
AnalyticScene randomTableScene(std::uint64_t seed, int count);

}  // namespace recognition
