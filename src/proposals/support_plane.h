#pragma once

#include <optional>

#include "alignment/scene_view.h"

namespace recognition {

/// What objects stand on; camera optical frame.
struct SupportPlane {
  Eigen::Vector3f up = Eigen::Vector3f::Zero();  ///< unit, to the camera's side
  float height = 0.0f;                           ///< up . p of its points p, metres
};

/// The largest of the planes that segmentation removed: rather one that rises away from the camera than a wall. None if
/// no plane holds a fifth of what was removed. Same result every time.
std::optional<SupportPlane> findSupportPlane(const SceneView& scene);

}  // namespace recognition
