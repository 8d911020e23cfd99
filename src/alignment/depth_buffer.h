#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/pose.h"
#include "alignment/prepared_model.h"

namespace recognition {

/// ^s M_j of eq. (10): the model as the sensor would see it alone. Images cover `box` of the depth image only.
struct ReprojectedModel {
  cv::Rect box;    ///< in the depth image; empty if nothing of the model is in view
  cv::Mat depth;   ///< CV_32FC1 metres along the optical axis; 0 outside M_j
  cv::Mat point;   ///< CV_32SC1 index of the point seen; -1 outside M_j
  int pixels = 0;  ///< |M_j|
};

/// Eq. (10)-(11) through a depth buffer: each point that faces the camera covers its disc
/// (ModelCloud::point_radius), so that a sparse cloud leaves no holes; the nearest surface wins, on one surface the
/// point whose centre is nearest.
ReprojectedModel reproject(const ModelCloud& model, const Pose& camera_from_object, const CameraModel& camera);

/// About which points would be seen, fast: of `candidates` points, evenly over the cloud, the indices of those that
/// face the camera, lie in the image, and have no other candidate well in front of them.
std::vector<int> visiblePoints(const PreparedModel& model, const Pose& camera_from_object, const CameraModel& camera,
                               size_t candidates);

}  // namespace recognition
