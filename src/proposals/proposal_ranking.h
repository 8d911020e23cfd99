#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "rgbd_recognition/matching/hypothesis.h"
#include "alignment/scene_view.h"
#include "alignment/surface_probe.h"
#include "alignment/prepared_model.h"

namespace recognition {

/// A pose that something less than a consensus set proposes, and what a look at it says.
struct Proposal {
  int object = -1;
  Pose camera_from_object = Pose::Identity();
  std::optional<Correspondence> pair;  ///< that it comes from
  ProbeResult probe;
  double support = 0.0;   ///< logarithm of the number of correspondences that propose about the same
  double priority = 0.0;  ///< the larger, the sooner tested; see rate()

  /// Sets the priority, before it is drawn to the depth or afterwards. Weights fitted on simulated scenes, to what
  /// becomes a right pose.
  void rate(bool refined);
};

struct ProposalLimits {
  size_t refined = 400;  ///< that are drawn to the depth, all objects
  size_t tested_per_object = 4;
  size_t tested = 64;       ///< all objects
  double free_space = 0.2;  ///< most of one that is tested, see ProbeResult
};

constexpr int kFirstProbe = 120, kSecondProbe = 400;  ///< points of probeSurface(), before and after refinement
constexpr int kAlignmentPoints = 120;                 ///< of the first alignment to the depth

/// Sorts by falling priority and keeps the first `count`.
void keepBest(size_t count, std::vector<Proposal>* proposals);

/// The same with those of one object only that differ from one another.
void keepDistinct(const PreparedModel& model, size_t count, std::vector<Proposal>* proposals);

/// Refines the proposals of the highest priority by depth, looks again, and returns those that deserve a test, the
/// highest priority first. `by_object`: one list an object. Same result for any number of threads.
std::vector<Hypothesis> hypothesesOf(std::vector<std::vector<Proposal>> by_object, const PreparedModels& models,
                                     const SceneView& scene, const ProposalLimits& limits);

}  // namespace recognition
