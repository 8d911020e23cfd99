#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/model/object_model.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition::synthetic {

/// A printed box or can, known in closed form: axis-aligned round the object's origin, a can's axis is y.
struct Solid {
  enum class Shape { kBox, kCan } shape = Shape::kBox;
  Eigen::Vector3d half = {0.05, 0.08, 0.03};                 ///< half extents, metres; a can's radius is half.x()
  std::function<cv::Vec3b(const Eigen::Vector3d&)> texture;  ///< RGB at a surface point

  /// Distance along the ray (object frame) to the surface, negative if missed; `normal` is outward.
  double intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Eigen::Vector3d* normal) const;
};

/// Patches of random colours, about a centimetre wide.
std::function<cv::Vec3b(const Eigen::Vector3d&)> patchwork(std::uint32_t seed);

Solid box(std::uint32_t seed);
Solid can(std::uint32_t seed);

/// The model of a solid: cloud of about 2 mm spacing, `features` random places on the surface as features.
ObjectModel makeModel(const Solid& solid, const std::string& name, int features = 200);

struct Placed {
  Solid solid;
  Pose camera_from_object = Pose::Identity();
};

struct Sensor {
  CameraModel camera{640, 480, 525.0, 525.0, 319.5, 239.5};
  double depth_noise = 1.0;         ///< multiples of depthSigma()
  double depth_scale = 1.0;         ///< of all depths
  double keypoint_noise = 0.4;      ///< pixels
  double gain = 1.0, offset = 0.0;  ///< of the colour, 8 bit
  double color_noise = 2.0;
  std::uint32_t seed = 7;
};

/// A frame with all that its SceneView points to.
struct Scene {
  RgbdFrame frame;
  cv::Mat depth, instance;    ///< instance: CV_32SC1 index in the placed solids, -1 background
  Segmentation segmentation;  ///< one patch a solid
  SceneFeatures features;
  std::vector<Hypothesis>
      truth;  ///< one a solid: true pose, all visible features as consensus; object = index of the solid
  SceneView view;
};

/// Renders solids before a wall at 1.6 m. models[i] is the model of placed[i].
std::unique_ptr<Scene> render(const std::vector<Placed>& placed, const std::vector<ObjectModel>& models,
                              const Sensor& sensor);

/// camera_from_object at `position`, turned by `degrees` about an axis, from a view that shows three faces of a box.
Pose poseAt(const Eigen::Vector3d& position, double degrees = 0.0,
            const Eigen::Vector3d& axis = Eigen::Vector3d::UnitY());

/// A pose moved by `metres` and turned about the object's origin by `degrees`, directions from the seed.
Pose disturbed(const Pose& pose, double metres, double degrees, std::uint32_t seed);

ModelDatabase databaseOf(const std::vector<ObjectModel>& models);

}  // namespace recognition::synthetic
