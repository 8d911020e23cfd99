#pragma once

#include <vector>

#include "alignment/prepared_model.h"

namespace recognition {

/// Frame of the principal axes, its origin in the middle of the extent along each (not in the mean: scans are uneven).
PrincipalShape principalShape(const std::vector<Eigen::Vector3f>& positions);

/// Poses fixed_from_moving that lay the surface of one model onto that of another within a few of its points' spacings:
/// turns about the principal axes, and half turns across them. Of a model onto itself: its symmetries, the identity
/// among them. TextureColumns does not count. Empty if the sizes differ.
std::vector<Pose> alignShapes(const PreparedModel& fixed, const PreparedModel& moving);

}  // namespace recognition
