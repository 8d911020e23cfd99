#pragma once

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// Correlation of the brightness of the two clouds where they overlap: whatever the illumination was, one texture is bright
/// and dark in the same places. What follows from how far a surface looks up, in either pass, is taken out, as light
/// comes from above. Objects of one shape with different textures agree in their edges' features, and not in this.
double textureCorrelation(const ObjectModel& model, const ObjectModel& addition, const Pose& model_from_addition);

/// Share of both clouds' points that cannot be there, since they lie below what the other stood on, or well in front of
/// what the other was seen to have from one of the directions that its features were seen from. Surfaces that slide
/// along themselves, as those of cans do, agree in their overlap, and not in this.
double contradictedShare(const ObjectModel& model, const ObjectModel& addition, const Pose& model_from_addition);

}  // namespace recognition
