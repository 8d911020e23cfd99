#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// How each feature is turned: its axes are where its orientation in the image points to on the surface, what is across,
/// and the surface's normal; in the camera's optical frame and in the object's. The way to the camera stands in for a
/// normal that is not known or too steep. Model normals are those of the `cloud` beside them. Empty if the model has no
/// orientations.
std::vector<Eigen::Quaternionf> featureFrames(const SceneFeatures& scene);
std::vector<Eigen::Quaternionf> featureFrames(const ModelFeatures& model, const std::vector<SurfacePoint>& cloud = {});

/// Rotation of the object that one correspondence alone proposes: what turns the model feature's frame into the scene
/// feature's. Right within the errors of normals and orientations, or, where a view stands in for the normal, within the
/// angle between the trained view and the camera's. Empty if the model has no frames.
std::vector<Eigen::Quaternionf> impliedRotations(const std::vector<Correspondence>& pairs,
                                                 const std::vector<Eigen::Quaternionf>& scene_frames,
                                                 const std::vector<Eigen::Quaternionf>& model_frames);

/// When two correspondences can belong to one pose.
struct ConsistencyLimits {
  /// `epsilon_g`: tolerance of eq. (8), metres. `max_rotation`: degrees between the rotations that the two propose.
  ConsistencyLimits(double epsilon_g = 0.01, double max_rotation = 180.0);

  float epsilon;        ///< metres
  bool any_rotation;    ///< not tested
  float min_cosine;     ///< of half the angle between the rotations
  float max_deviation;  ///< of the line between the model's features, turned, as a share of its length
};

/// Members of a set as bits, 64 to a word, the first in the lowest bit.
using BitWord = std::uint64_t;
constexpr int kWordBits = 64;
inline int wordsFor(int count) { return (count + kWordBits - 1) / kWordBits; }

class UniqueFeatures;

/// Where a correspondence has its features, metres.
struct FeaturePlaces {
  Eigen::Vector3f scene;
  Eigen::Vector3f model;
};

/// Correspondences with the places of their features: scene points in the camera's optical frame, model points in the
/// object's, metres. Coordinates lie one axis after the other, for SIMD.
class CorrespondenceSet {
 public:
  CorrespondenceSet() = default;
  /// `rotations` as impliedRotations() gives them.
  CorrespondenceSet(const std::vector<Correspondence>& pairs, const std::vector<Eigen::Vector3f>& scene_points,
                    const std::vector<Eigen::Vector3f>& model_points,
                    const std::vector<Eigen::Quaternionf>& rotations = {});

  int size() const { return static_cast<int>(pairs_.size()); }
  const Correspondence& pair(int i) const { return pairs_[i]; }
  Eigen::Vector3f scenePoint(int i) const { return {columns_[0][i], columns_[1][i], columns_[2][i]}; }
  Eigen::Vector3f modelPoint(int i) const { return {columns_[3][i], columns_[4][i], columns_[5][i]}; }
  FeaturePlaces places(int i) const { return {scenePoint(i), modelPoint(i)}; }
  bool oriented() const { return oriented_; }  ///< whether rotations are known
  Eigen::Quaternionf rotation(int i) const { return {columns_[9][i], columns_[6][i], columns_[7][i], columns_[8][i]}; }

  /// Makes this set hold the members of another, in the order given; keeps its memory.
  void assign(const CorrespondenceSet& from, const std::vector<int>& members);

  /// FindConsistent: those whose distance to `fixed` is the same in the scene and on the model, eq. (8). `fixed` itself
  /// is in; others that share a feature with it are not. In order.
  ///
  /// Beyond the paper, where rotations are known: the two must propose about the same rotation, and that of `fixed`
  /// must turn the line between the model's features into about the line between the scene's.
  void findConsistent(int fixed, const ConsistencyLimits& limits, std::vector<int>& consistent) const;
  /// The same as bits: wordsFor(size()) words.
  void markConsistent(int fixed, const ConsistencyLimits& limits, BitWord* consistent) const;

  /// Ours, beyond the paper: whether some pose that brings both fixed features to their places (Fig. 4: what is open is
  /// a turn about the line through them) brings more than `least` correspondences within `tolerance`, metres. The turns
  /// tried are those of the correspondences themselves; features count once.
  bool rotateTogether(const FeaturePlaces& first, const FeaturePlaces& second, float tolerance, int least,
                      UniqueFeatures& unique) const;

  /// Squared distance (m^2) between scene point and transformed model point: eq. (9), all correspondences. Returns how
  /// many are not above `limit`.
  int squaredResiduals(const Pose& camera_from_object, float limit, std::vector<float>& residuals) const;

 private:
  std::vector<Correspondence> pairs_;
  std::array<std::vector<float>, 10> columns_;  ///< scene x y z, model x y z, rotation x y z w
  std::vector<std::int32_t> scene_features_, model_features_;
  bool oriented_ = false;
};

/// Calls `use` with the number of each bit that is set, in order.
template <typename Use>
void forEachBit(const BitWord* bits, int words, Use use) {
  for (int w = 0; w < words; ++w)
    for (BitWord word = bits[w]; word != 0; word &= word - 1) use(w * kWordBits + __builtin_ctzll(word));
}

/// Picks members so that each scene feature and each model feature supports a consensus only once.
class UniqueFeatures {
 public:
  /// Starts a new selection.
  void clear() {
    ++stamp_;
    scene_.count = model_.count = 0;
  }
  /// True, and takes both features, if neither is taken yet.
  bool take(const Correspondence& pair);
  /// Takes both features, even if one is taken; the number of its scene feature among those taken.
  int note(const Correspondence& pair);
  int sceneFeatures() const { return scene_.count; }
  /// Most members that a one-to-one selection of the noted pairs can have, bounded from above.
  int bound() const { return std::min(scene_.count, model_.count); }
  /// The same among `members` of `set`.
  int bound(const CorrespondenceSet& set, const std::vector<int>& members);

 private:
  /// Features taken since clear(), numbered in order.
  struct Numbers {
    std::vector<int> stamps, numbers;  ///< by feature
    int count = 0;

    bool has(int feature, int stamp) const {
      return feature < static_cast<int>(stamps.size()) && stamps[feature] == stamp;
    }
    int add(int feature, int stamp);
  };

  Numbers scene_, model_;
  int stamp_ = 0;
};

}  // namespace recognition
