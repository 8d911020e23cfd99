#pragma once

#include "core/angles.h"
#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"

namespace recognition {

// From where on a true pose must be accepted.
constexpr int kManyFeatures = 8;  // that agree with it
constexpr double kMinSeen = 0.3;  // of the object

constexpr double kSameRotation = 20;  // degrees

/// Whether the test left the hypothesis at that pose: within `metres` and kSameRotation.
inline bool isAt(const VerifiedHypothesis& tested, const Pose& truth, double metres) {
  return translationDistance(tested.camera_from_object, truth) < metres &&
         rotationDistance(tested.camera_from_object, truth) < kSameRotation * kDegree;
}

}  // namespace recognition
