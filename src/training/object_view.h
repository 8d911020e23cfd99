#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/core/pose.h"

namespace recognition {

constexpr float kPaper = 240.0f;  ///< what the board's paper is in the colours of a model, of 255

/// A point of the world where a view measured something.
struct PointInView {
  Eigen::Vector3d position;  ///< the point's, camera frame, metres
  cv::Point pixel;           ///< of depth
  double gap = 0.0;          ///< from the point's depth to what is measured there, metres: positive behind the point
};

/// A view that is used, as the steps of training see it.
struct ObjectView {
  cv::Mat color;  ///< CV_8UC3 RGB, as recorded
  cv::Mat depth;  ///< CV_32FC1 metres, 0 invalid
  CameraModel color_camera;
  CameraModel depth_camera;
  int color_per_depth = 1;
  Pose camera_from_world = Pose::Identity();
  cv::Mat mask;                              ///< CV_8UC1, depth resolution: 255 on the object
  cv::Vec3f paper = cv::Vec3f::all(kPaper);  ///< RGB of the board's paper, see colorOfPaper()
  double board_rms = 0.0;                    ///< pixels
  double board_spread = 0.0;                 ///< of that over the board
  double board_scale = 1.0;                  ///< board's size by depth over its size by description

  Eigen::Vector3f worldPoint(int u, int v) const {
    return (camera_from_world.inverse() * depth_camera.unproject(u, v, depth.at<float>(v, u))).cast<float>();
  }
  /// Nothing where a point (world frame) is outside of the view, or nothing was measured.
  std::optional<PointInView> find(const Eigen::Vector3f& point) const;
  Eigen::Vector3f cameraPlace() const { return camera_from_world.inverse().translation().cast<float>(); }
};

/// Copies the frame; throws std::invalid_argument for one that does not fit. Pose and mask are left to the caller.
ObjectView makeObjectView(const RgbdFrame& frame);

/// Smallest valid depth of the 3x3 pixels about each valid pixel, 0 elsewhere: what is nearer is in front of all of
/// them, however a depth edge wanders.
cv::Mat nearestDepthAround(const cv::Mat& depth);

/// A measured point of the object's surface.
struct Surfel {
  Eigen::Vector3f position;  ///< camera frame of its view, metres
  Eigen::Vector3f normal;    ///< unit, towards the camera
  cv::Vec3b rgb;
  float weight = 1.0f;  ///< of the position: inverse variance, seen straight on or not
  bool inner = true;    ///< well inside the object's outline, where no edge's depth reaches it
};

/// The object's surface in one view: every `stride`-th pixel inside the mask's rim that has a normal.
std::vector<Surfel> measureSurface(const ObjectView& view, int stride);

}  // namespace recognition
