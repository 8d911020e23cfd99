#pragma once

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"
#include "alignment/resting_shape.h"

namespace recognition {

/// Principal axes of a surface, smallest variance first, and its extents along them.
struct PrincipalShape {
  Pose object_from_principal = Pose::Identity();
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< metres
};

/// Points of a model's surface, object frame; coordinates lie one axis after the other, for SIMD.
struct ProbePoints {
  std::array<std::vector<float>, 3> position;  ///< metres
  std::array<std::vector<float>, 3> normal;    ///< unit, outward
  std::vector<cv::Vec3f> lab;                  ///< CIELAB

  int count() const { return static_cast<int>(lab.size()); }
};

/// A cloud P in the form that reprojection reads fast.
struct ModelCloud {
  std::vector<Eigen::Vector3f> positions;  ///< object frame, metres
  std::vector<Eigen::Vector3f> normals;    ///< unit, outward
  std::vector<cv::Vec3f> lab;              ///< CIELAB
  float point_radius = 0.0f;               ///< discs of this radius round all points cover the surface, metres
};

/// An object's model as the search reads it.
struct PreparedModel : ModelCloud {
  ModelCloud coarse;                                 ///< a quarter of the points, for half resolution
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< mean of the positions
  float radius = 0.0f;  ///< of the smallest sphere round `centre` that holds all points, metres
  PrincipalShape shape;
  ProbePoints probe_points;  ///< some of the cloud; any beginning of them covers the surface about evenly
  std::vector<RestingPose> resting_poses;
  FaceTable faces, halves;  ///< of `probe_points`: what looks about one way, and what is seen from there
  std::map<DescriptorType, std::vector<Eigen::Quaternionf>> feature_frames;  ///< see featureFrames()
};

/// Throws std::invalid_argument that names the object if its cloud has fewer than 4 points or a value that is not
/// finite.
PreparedModel prepareModel(const ObjectModel& object);

/// Another object, or the same one turned, that has the same shape: what a texture that repeats, a brand's logo or a twin
/// can make a hypothesis be taken for.
struct SymmetricAlternative {
  int object = -1;
  Pose object_from_other = Pose::Identity();  ///< camera_from_other = camera_from_object * object_from_other
};

/// The prepared models of a database, each made when first asked for. Shared between frames; safe to use from several
/// threads.
class PreparedModels {
 public:
  /// Throws std::invalid_argument as prepareModel() does.
  explicit PreparedModels(const ModelDatabase& database);

  /// Prepares all models, in parallel, so that no frame waits for it.
  void prepareAll() const;

  int count() const { return static_cast<int>(objects_.size()); }
  const ObjectModel& object(int index) const { return *objects_.at(static_cast<size_t>(index)); }
  const PreparedModel& at(int index) const;
  /// All that has the shape of an object, without the object itself as it stands.
  const std::vector<SymmetricAlternative>& alternatives(int index) const;

 private:
  struct Slot {
    std::once_flag once;
    PreparedModel model;
    std::once_flag once_alternatives;
    std::vector<SymmetricAlternative> alternatives;
  };
  std::vector<std::shared_ptr<const ObjectModel>> objects_;
  std::unique_ptr<Slot[]> slots_;  // guarded by each slot's flags
};

}  // namespace recognition
