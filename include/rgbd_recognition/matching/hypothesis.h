#pragma once

#include <vector>

#include "rgbd_recognition/core/pose.h"

namespace rgbd_recognition {

/// <^s tau, ^o tau>: a scene feature and a model feature that look alike.
struct Correspondence {
  int scene_feature = -1;  ///< index in SceneFeatures::points
  int model_feature = -1;  ///< row in the object's ModelFeatures
  float distance = 0.0f;   ///< Euclidean, of unit-length descriptors
};

/// An object that may be in the scene, with where. A consensus of one is a suggestion: see suggestPoses().
struct Hypothesis {
  int object = -1;  ///< index in ModelDatabase::objects
  Pose camera_from_object = Pose::Identity();
  std::vector<Correspondence> consensus;  ///< consensus set of Algorithm 2; its size is c_j
  int round = 0;                          ///< 0 for the first pass over the frame

  bool isSuggestion() const { return consensus.size() == 1; }
};

}  // namespace rgbd_recognition
