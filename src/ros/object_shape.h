#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"
#include "ros/messages.h"

namespace recognition {

/// A box in any orientation.
struct OrientedBox {
  Pose object_from_box = Pose::Identity();         ///< origin in the box's middle, axes along its edges
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< metres, along these axes
};

/// The box of least volume that holds the cloud, among those with an edge along an axis of the object's frame. Along
/// all three where that is as good within 2 %.
OrientedBox boxAround(const std::vector<SurfacePoint>& cloud);

/// The URI of the mesh file that a model was trained from, if it is still there; else empty.
std::string meshUri(const ObjectModel& model);

/// What grasp planners and scenes want of an object beside its pose. Made once a model.
class ObjectShapes {
 public:
  /// Fills in box, size and mesh of detections whose poses are set.
  void fillIn(const ModelDatabase& database, messages::DetectionArray* detections);

 private:
  struct Shape {
    OrientedBox box;
    std::string mesh;
    double mesh_scale = 0.0;
  };
  const Shape& of(const std::shared_ptr<const ObjectModel>& model);

  std::map<std::shared_ptr<const ObjectModel>, Shape> shapes_;
};

}  // namespace recognition
