#pragma once

#include <vector>

#include "rgbd_recognition/core/parameters.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// When features of two training views are one feature of the object.
struct MergingParameters {
  double distance = 0.0025;  ///< largest, between their places on the surface, metres
  double size_share = 0.08;  ///< of a feature's size, added to `distance`: large features are placed less exactly
  double size_ratio = 1.4;   ///< largest, between their sizes
  double descriptor_distance = 0.45;  ///< largest, of unit-length descriptors
  int max_features = 6000;            ///< kept an object and type: those seen in most views

  ParameterList list();
  void validate() const;
};

/// D, eq. (5), from the features of several views of one object, all in the object frame and of one type. Features that
/// agree in place, size and descriptor become one, with the mean descriptor (of unit length again), place, direction
/// and size. Elements of a view should come by falling strength: features of as many views keep that order. The same
/// input gives the same result.
ModelFeatures mergeFeatures(const std::vector<ModelFeatures>& views, const MergingParameters& parameters);

}  // namespace recognition
