#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "rgbd_recognition/core/extents.h"
#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/features/feature_types.h"

namespace recognition {

/// One element <p, c> of the coloured cloud P, eq. (3), with the surface's outward normal.
struct SurfacePoint {
  Eigen::Vector3f position;  ///< object frame, metres
  Eigen::Vector3f normal;    ///< object frame, unit length
  cv::Vec3b rgb;             ///< red, green, blue
};

/// D, eq. (5): descriptors with their places on the object. Row i of `descriptors` belongs to element i of each vector.
struct ModelFeatures {
  cv::Mat descriptors;                     ///< n x descriptorLength(type), CV_8SC1 (see quantizedDescriptors()), or
                                           ///< CV_32FC1 of unit length while in training
  std::vector<Eigen::Vector3f> positions;  ///< object frame, metres
  std::vector<Eigen::Vector3f>
      view_directions;  ///< object frame, unit, from the feature towards the camera(s) that saw it
  /// Object frame, unit, perpendicular to view_directions: where the keypoint's angle points to on the surface. Empty
  /// if not known.
  std::vector<Eigen::Vector3f> orientations;
  std::vector<float> sizes;          ///< feature size on the surface (keypoint diameter), metres
  std::vector<std::uint16_t> views;  ///< training views merged into it

  int count() const { return descriptors.rows; }
};

/// A plane on which an object stood: nothing of the object lies below, and something touches it.
struct RestPlane {
  Eigen::Vector3f normal;  ///< object frame, unit, up
  float offset = 0.0f;     ///< metres, of the plane's points along the normal

  float heightOf(const Eigen::Vector3f& p) const { return normal.dot(p) - offset; }
};

/// The 3-tuple <P, D, Sigma> of Sec. III. D once per descriptor type, so that one store serves several configurations.
struct ObjectModel {
  std::string name;                                  ///< unique in a database; letters, digits, '_', '-', '.'
  int challenge_id = -1;                             ///< dID / BOP obj_id; -1 where it has none
  std::string source;                                ///< where it was trained from
  std::map<std::string, std::string> provenance;     ///< how: parameters, checksums, dates; for people and for resuming
  std::vector<SurfacePoint> cloud;                   ///< P
  std::map<DescriptorType, ModelFeatures> features;  ///< D
  Extents extents;                                   ///< Sigma
  std::vector<RestPlane> rest_planes;                ///< on which it stood as it was recorded; none from a mesh
};

/// Eq. (4) from the PCA of the positions; throws std::invalid_argument for fewer than 4 points.
Extents computeExtents(const std::vector<SurfacePoint>& cloud);

/// The same in another frame; Sigma does not depend on it.
ModelFeatures moved(ModelFeatures features, const Pose& to_from);
ObjectModel moved(ObjectModel model, const Pose& to_from);

/// All trained objects: immutable once made, shared between stages and threads. Index in `objects` is the object's id
/// inside one process.
struct ModelDatabase {
  std::vector<std::shared_ptr<const ObjectModel>> objects;

  /// Index of the object, or -1.
  int find(const std::string& name) const;
};

/// Smallest sigma_min and largest sigma_max over the database: the limits of Sec. IV-A. {0, 0, 0} when empty.
Extents extentLimits(const ModelDatabase& database);

}  // namespace recognition
