#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rgbd_recognition/features/feature_types.h"
#include "matching/correspondence_search.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/matching/matching_parameters.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/matching/scene_matches.h"

namespace recognition {

/// Sec. V: scene features -> hypotheses, over all models of a database (index of their descriptors, then Algorithm 2 an
/// object). Immutable, safe to use from several threads.
class HypothesisGenerator {
 public:
  /// Builds the index over all models' descriptors of `type`; throws std::invalid_argument that names a model without
  /// them.
  HypothesisGenerator(const MatchingParameters& parameters, std::shared_ptr<const ModelDatabase> database,
                      DescriptorType type);
  ~HypothesisGenerator();

  /// FindFeatureCorrespondences for all objects. Throws std::invalid_argument if the descriptors are of another type.
  SceneMatches match(const SceneFeatures& scene) const;

  /// Algorithm 2 on the features i with active[i] != 0 (empty: all), for `objects` (empty: all). Deterministic for any
  /// number of threads. Order: by object, then by falling consensus. Throws std::invalid_argument if sizes or object
  /// indices do not fit.
  ///
  /// Several hypotheses an object: after the largest consensus all correspondences that agree with its pose are taken
  /// out and the search runs again, so other instances follow, and other poses over the same features (a label printed
  /// twice). Objects of the highest priority come first, a few at a time, and share half of the budget that is left.
  std::vector<Hypothesis> generate(const SceneFeatures& scene, const SceneMatches& matches,
                                   const std::vector<std::uint8_t>& active, const std::vector<int>& objects, int round,
                                   GenerationReport* report = nullptr) const;

  /// Memory of the generator's own copy of the descriptors, bytes.
  size_t bytes() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
