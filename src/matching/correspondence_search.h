#pragma once

#include <memory>
#include <vector>

#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/matching/matching_parameters.h"
#include "rgbd_recognition/matching/scene_matches.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// FindFeatureCorrespondences of Algorithm 2, for all objects at once. Distances are those of 8-bit descriptors (see
/// quantized_descriptors.h). Immutable, safe to use from several threads.
class CorrespondenceSearch {
 public:
  virtual ~CorrespondenceSearch() = default;
  virtual SceneMatches match(const SceneFeatures& scene) const = 0;

  /// Memory of the search's own copy of the descriptors, bytes.
  virtual size_t bytes() const = 0;
};

/// `models` one element an object; they must outlive the search.
std::unique_ptr<CorrespondenceSearch> makeCorrespondenceSearch(const MatchingParameters& parameters,
                                                               const std::vector<const ModelFeatures*>& models,
                                                               int length);

/// Diameter of each scene feature on the surface it lies on, metres: keypoint size * z / f; all 0 where f is unknown.
std::vector<float> metricSizes(const SceneFeatures& scene);

}  // namespace recognition
