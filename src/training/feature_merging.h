#pragma once

#include <vector>

#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/training/training_parameters.h"

namespace recognition {

/// D, eq. (5), from the features of several views of one object, all in the object frame and of one type. Features that
/// agree in place, size and descriptor become one, with the mean descriptor (of unit length again), place, direction
/// and size. Elements of a view should come by falling strength: features of as many views keep that order. The same
/// input gives the same result.
ModelFeatures mergeFeatures(const std::vector<ModelFeatures>& views, const MergingParameters& parameters);

}  // namespace recognition
