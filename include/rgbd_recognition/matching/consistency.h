#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/matching/hypothesis.h"

namespace rgbd_recognition {

/// Correspondences with the places of their features: scene points in the camera's optical frame, model points in the
/// object's, metres. Coordinates lie one axis after the other, for SIMD.
class CorrespondenceSet {
 public:
  CorrespondenceSet() = default;
  CorrespondenceSet(const std::vector<Correspondence>& pairs, const std::vector<Eigen::Vector3f>& scene_points,
                    const std::vector<Eigen::Vector3f>& model_points);

  int size() const { return static_cast<int>(pairs_.size()); }
  const Correspondence& pair(int i) const { return pairs_[i]; }
  Eigen::Vector3f scenePoint(int i) const { return {scene_[0][i], scene_[1][i], scene_[2][i]}; }
  Eigen::Vector3f modelPoint(int i) const { return {model_[0][i], model_[1][i], model_[2][i]}; }

  /// Makes this set hold the members of another, in the order given; keeps its memory.
  void assign(const CorrespondenceSet& from, const std::vector<int>& members);

  /// FindConsistent: those whose distance to `fixed` is the same in the scene and on the model, eq. (8), within
  /// epsilon_g (metres). `fixed` itself is in; others that share a feature with it are not. In order.
  void findConsistent(const CorrespondenceSet& fixed_in, int fixed, double epsilon_g,
                      std::vector<int>& consistent) const;

  /// Squared distance (m^2) between scene point and transformed model point: eq. (9), all correspondences.
  void squaredResiduals(const Pose& camera_from_object, std::vector<float>& residuals) const;

 private:
  void push(const Correspondence& pair, const Eigen::Vector3f& scene_point, const Eigen::Vector3f& model_point);

  std::vector<Correspondence> pairs_;
  std::array<std::vector<float>, 3> scene_, model_;
};

/// Picks members so that each scene feature and each model feature supports a consensus only once.
class UniqueFeatures {
 public:
  /// Starts a new selection.
  void clear() { ++stamp_; }
  /// True, and takes both features, if neither is taken yet.
  bool take(const Correspondence& pair);
  /// Most members that a one-to-one selection among `members` of `set` can have, bounded from above.
  int bound(const CorrespondenceSet& set, const std::vector<int>& members);

 private:
  bool mark(std::vector<int>& stamps, int feature);
  bool marked(const std::vector<int>& stamps, int feature) const;

  std::vector<int> scene_, model_;
  int stamp_ = 0;
};

}  // namespace rgbd_recognition
