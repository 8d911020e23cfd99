#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rgbd_recognition/core/parameters.h"
#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/model/object_model.h"

namespace rgbd_recognition {

/// Parameters of Sec. V's matching (Table III and ours).
struct MatchingParameters {
  double delta_f = 1.0;

  ParameterList list();
  void validate() const;
};

/// Correspondences of one frame with all objects, found once and used by every round.
struct SceneMatches {
  std::vector<std::vector<Correspondence>> by_object;  ///< index as in ModelDatabase::objects; sorted by distance (T_f)
};

/// What the generation left out or spent, for diagnostics.
struct GenerationReport {
  bool budget_exhausted = false;
  std::vector<int> objects_cut_short;  ///< indices of objects whose search was stopped by the budget
};

/// Sec. V: scene features -> hypotheses, over all models of a database (index of their descriptors, then Algorithm 2 an object).
class HypothesisGenerator {
 public:
  /// Builds the index over all models' descriptors of `type`; throws std::invalid_argument that names a model without them.
  HypothesisGenerator(const MatchingParameters& parameters, std::shared_ptr<const ModelDatabase> database, DescriptorType type);
  ~HypothesisGenerator();

  /// FindFeatureCorrespondences for all objects. Throws std::invalid_argument if the descriptors are of another type.
  SceneMatches match(const SceneFeatures& scene) const;

  /// Algorithm 2 on the features i with active[i] != 0 (empty: all), for `objects` (empty: all). Deterministic for any number of threads. Order:
  /// by object, then by falling consensus.
  std::vector<Hypothesis> generate(const SceneFeatures& scene, const SceneMatches& matches, const std::vector<std::uint8_t>& active,
                                   const std::vector<int>& objects, int round, GenerationReport* report = nullptr) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbd_recognition
