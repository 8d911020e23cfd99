#pragma once

#include <vector>

#include "rgbd_recognition/core/pose.h"

namespace recognition {

/// <^s tau, ^o tau>: a scene feature and a model feature that look alike.
struct Correspondence {
  int scene_feature = -1;  ///< index in SceneFeatures::points
  int model_feature = -1;  ///< row in the object's ModelFeatures
  float distance = 0.0f;   ///< Euclidean, of unit-length descriptors
};

/// How a hypothesis came about.
enum class HypothesisSource {
  kConsensus,       ///< Algorithm 2
  kCorrespondence,  ///< a single correspondence proposes it: see proposeByCorrespondence()
  kShape,           ///< a surface of the scene, as one of the object's own: see proposeRestingPoses()
  kAlternative      ///< it looks like another hypothesis in shape: see testAlternatives()
};

constexpr int kHypothesisSources = 4;

const char* sourceName(HypothesisSource source);  ///< "consensus", "correspondence", "shape", "alternative"

/// Without a consensus set: what speaks for it is found in the frame.
inline bool lacksConsensus(HypothesisSource source) {
  return source == HypothesisSource::kCorrespondence || source == HypothesisSource::kShape;
}

/// An object that may be in the scene, with where.
struct Hypothesis {
  int object = -1;  ///< index in ModelDatabase::objects
  Pose camera_from_object = Pose::Identity();
  std::vector<Correspondence> consensus;  ///< consensus set of Algorithm 2; its size is c_j
  int round = 0;                          ///< 0 for the first pass over the frame
  HypothesisSource source = HypothesisSource::kConsensus;
};

}  // namespace recognition
