#pragma once

#include <vector>

#include "training/object_view.h"
#include "rgbd_recognition/training/recorded_object.h"

namespace recognition {

/// An upright cylinder in the world that holds the object, found by itself.
struct ObjectRegion {
  Eigen::Vector2f axis = Eigen::Vector2f::Zero();  ///< metres
  float radius = 0.0f;
  float bottom = 0.0f;
  float top = 0.0f;
  float margin = 0.0f;  ///< of radius and top around what was found

  float innerRadius() const { return radius - margin; }

  bool contains(const Eigen::Vector3f& p) const {
    return p.z() >= bottom && p.z() <= top && (p.head<2>() - axis).squaredNorm() <= radius * radius;
  }
};

/// Where, over all views, something stands above the plane z = 0 within the parameters' limits: the connected thing
/// nearest to the middle. Throws std::runtime_error if there is nothing, or if it reaches the limits.
ObjectRegion findObjectRegion(const std::vector<ObjectView>& views, const RecordingParameters& parameters);

/// Pixels of the view inside the region, without specks.
cv::Mat maskOfRegion(const ObjectView& view, const ObjectRegion& region);

}  // namespace recognition
