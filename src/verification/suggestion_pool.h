#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/verification/scene_view.h"
#include "rgbd_recognition/verification/surface_probe.h"

namespace rgbd_recognition {

/// A pose that something less than a consensus set suggests, and what a look at it says.
struct Suggestion {
  int object = -1;
  Pose camera_from_object = Pose::Identity();
  std::optional<Correspondence> pair;  ///< that it comes from
  ProbeResult probe;
  double support = 0.0;  ///< logarithm of the number of correspondences that suggest about the same
  double promise = 0.0;  ///< the larger, the sooner tested; see rate()

  /// Sets the promise, before it is drawn to the depth or afterwards. Weights fitted on simulated scenes, to what
  /// becomes a right pose.
  void rate(bool refined);
};

struct SuggestionLimits {
  size_t refined = 400;  ///< that are drawn to the depth, all objects
  size_t tested_per_object = 4;
  size_t tested = 64;       ///< all objects
  double free_space = 0.2;  ///< most of one that is tested, see ProbeResult
};

constexpr int kFirstProbe = 120, kSecondProbe = 400;  ///< points of probeSurface(), before and after refinement

/// Sorts by falling promise and keeps the first `count`.
void keepPromising(size_t count, std::vector<Suggestion>* suggestions);

/// The same with those of one object only that differ from one another.
void keepDistinct(const PreparedModel& model, size_t count, std::vector<Suggestion>* suggestions);

/// Draws the most promising to the frame's depth, looks again, and returns those that deserve a test, the most
/// promising first. `by_object`: one list an object. Same result for any number of threads.
std::vector<Hypothesis> hypothesesOf(std::vector<std::vector<Suggestion>> by_object, const PreparedModels& models,
                                     const SceneView& scene, const SuggestionLimits& limits);

}  // namespace rgbd_recognition
