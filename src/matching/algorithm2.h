#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "matching/consistency_graph.h"
#include "rgbd_recognition/matching/matching_parameters.h"

namespace recognition {

/// Work that a search may still do, counted in operations, not by the clock: the same frame gives the same result on a
/// busy machine. One unit is about 0.4 ns on a core of 2.5 GHz.
struct WorkBudget {
  std::int64_t left = 0;

  static WorkBudget milliseconds(double ms) { return {static_cast<std::int64_t>(ms * 2.5e6)}; }
  bool exhausted() const { return left <= 0; }
  void spend(std::int64_t units) { left -= units; }
};

/// A pose and the correspondences (indices in the set searched) that agree with it.
struct PoseConsensus {
  Pose camera_from_object = Pose::Identity();
  std::vector<int> members;

  int size() const { return static_cast<int>(members.size()); }
};

/// RANSAC Based Feature Matching: Algorithm 2 of the paper, Sec. V, after FindFeatureCorrespondences and Sort.
///
/// Beyond the paper: sets that cannot beat the largest consensus are not searched (see ConsistencyGraph::mayHoldClique
/// and CorrespondenceSet::rotateTogether); a RANSAC ends once a better sample
/// is unlikely (1 %), and draws its samples among the triangles that are congruent by eq. (8); each scene feature and each
/// model feature counts once in a consensus; sets near to a line count as none; and what MatchingParameters calls ours.
/// Not for concurrent use.
class Algorithm2 {
 public:
  Algorithm2(const MatchingParameters& parameters, std::uint32_t seed)
      : parameters_(parameters), limits_{parameters.epsilon_g, parameters.max_rotation}, random_(seed) {}

  /// The pose with the largest consensus, of more than `must_beat` correspondences; else no members. `set` sorted by
  /// distance (T_f).
  PoseConsensus search(const CorrespondenceSet& set, int must_beat, WorkBudget& budget);

 private:
  int filtered(int count, double fraction) const;
  void searchFixed(const CorrespondenceSet& set, int first, int must_beat, PoseConsensus& best, WorkBudget& budget);
  bool selectThird(const FeaturePlaces& first, int second, int must_beat, WorkBudget& budget);
  PoseConsensus ransac(const std::vector<int>& candidates, const BitWord* row, int must_beat, WorkBudget& budget);
  bool estimateFromSample(const std::vector<int>& candidates, const BitWord* row, Pose& pose, WorkBudget& budget);
  bool estimate(const CorrespondenceSet& set, const std::vector<int>& members, Pose& pose);
  /// Size that the consensus with a pose has at most; 0 if not above `must_beat`.
  int boundConsensus(const CorrespondenceSet& set, const Pose& pose, int must_beat);
  void collectConsensus(const CorrespondenceSet& set, const Pose& pose, std::vector<int>& members);
  bool isClear(const PoseConsensus& consensus) const;
  void markExplained(const CorrespondenceSet& set, const PoseConsensus& consensus);
  void refine(const CorrespondenceSet& set, PoseConsensus& consensus);
  bool mayUseRotations(const CorrespondenceSet& set, int count) const;

  MatchingParameters parameters_;
  ConsistencyLimits limits_;
  std::mt19937_64 random_;
  UniqueFeatures unique_;
  std::vector<std::uint8_t> explained_;  // by the pose of the largest consensus so far
  std::vector<std::uint8_t> fruitless_;  // fixed ones without a consensus that this one is consistent with
  std::vector<int> consistent2_, consistent3_, inliers_;
  ConsistencyGraph graph_;  ///< of T_beta
  CorrespondenceSet set_beta_, set3_;
  std::vector<float> residuals_;
  std::vector<Eigen::Vector3d> source_, target_;
  std::vector<Eigen::Quaternionf> rotations_;
};

}  // namespace recognition
