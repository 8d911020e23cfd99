#include "rgbd_recognition/matching/consistency.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "rgbd_recognition/core/simd.h"

namespace rgbd_recognition {
namespace {

struct Columns {
  const float* x;
  const float* y;
  const float* z;
};

RGBD_SIMD_CLONES void equalDistances(Columns s, Columns o, int count, const float* s1, const float* o1, float epsilon,
                                     std::uint8_t* equal) {
  for (int i = 0; i < count; ++i) {
    const float sx = s.x[i] - s1[0], sy = s.y[i] - s1[1], sz = s.z[i] - s1[2];
    const float ox = o.x[i] - o1[0], oy = o.y[i] - o1[1], oz = o.z[i] - o1[2];
    const float difference = std::sqrt(sx * sx + sy * sy + sz * sz) - std::sqrt(ox * ox + oy * oy + oz * oz);
    equal[i] = std::fabs(difference) <= epsilon ? 1 : 0;
  }
}

RGBD_SIMD_CLONES void residualsOf(Columns s, Columns o, int count, const float* r, const float* t, float* residuals) {
  for (int i = 0; i < count; ++i) {
    const float dx = s.x[i] - (r[0] * o.x[i] + r[1] * o.y[i] + r[2] * o.z[i] + t[0]);
    const float dy = s.y[i] - (r[3] * o.x[i] + r[4] * o.y[i] + r[5] * o.z[i] + t[1]);
    const float dz = s.z[i] - (r[6] * o.x[i] + r[7] * o.y[i] + r[8] * o.z[i] + t[2]);
    residuals[i] = dx * dx + dy * dy + dz * dz;
  }
}

Columns columns(const std::array<std::vector<float>, 3>& points) {
  return {points[0].data(), points[1].data(), points[2].data()};
}

}  // namespace

CorrespondenceSet::CorrespondenceSet(const std::vector<Correspondence>& pairs,
                                     const std::vector<Eigen::Vector3f>& scene_points,
                                     const std::vector<Eigen::Vector3f>& model_points) {
  for (const Correspondence& pair : pairs)
    push(pair, scene_points[pair.scene_feature], model_points[pair.model_feature]);
}

void CorrespondenceSet::push(const Correspondence& pair, const Eigen::Vector3f& scene_point,
                             const Eigen::Vector3f& model_point) {
  pairs_.push_back(pair);
  for (int axis = 0; axis < 3; ++axis) {
    scene_[axis].push_back(scene_point[axis]);
    model_[axis].push_back(model_point[axis]);
  }
}

void CorrespondenceSet::assign(const CorrespondenceSet& from, const std::vector<int>& members) {
  pairs_.clear();
  for (int axis = 0; axis < 3; ++axis) {
    scene_[axis].clear();
    model_[axis].clear();
  }
  for (const int i : members) push(from.pairs_[i], from.scenePoint(i), from.modelPoint(i));
}

void CorrespondenceSet::findConsistent(const CorrespondenceSet& fixed_in, int fixed, double epsilon_g,
                                       std::vector<int>& consistent) const {
  static thread_local std::vector<std::uint8_t> equal;
  equal.resize(pairs_.size());
  const Eigen::Vector3f s1 = fixed_in.scenePoint(fixed), o1 = fixed_in.modelPoint(fixed);
  const Correspondence& first = fixed_in.pair(fixed);
  equalDistances(columns(scene_), columns(model_), size(), s1.data(), o1.data(), static_cast<float>(epsilon_g),
                 equal.data());
  consistent.clear();
  for (int i = 0; i < size(); ++i) {
    if (!equal[i]) continue;
    const bool same_scene = pairs_[i].scene_feature == first.scene_feature;
    const bool same_model = pairs_[i].model_feature == first.model_feature;
    if (same_scene == same_model) consistent.push_back(i);  // both: `fixed` itself
  }
}

void CorrespondenceSet::squaredResiduals(const Pose& camera_from_object, std::vector<float>& residuals) const {
  residuals.resize(pairs_.size());
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> rotation = camera_from_object.linear().cast<float>();
  const Eigen::Vector3f translation = camera_from_object.translation().cast<float>();
  residualsOf(columns(scene_), columns(model_), size(), rotation.data(), translation.data(), residuals.data());
}

bool UniqueFeatures::marked(const std::vector<int>& stamps, int feature) const {
  return feature < static_cast<int>(stamps.size()) && stamps[feature] == stamp_;
}

bool UniqueFeatures::mark(std::vector<int>& stamps, int feature) {
  if (marked(stamps, feature)) return false;
  if (feature >= static_cast<int>(stamps.size())) stamps.resize(feature + 1, 0);
  stamps[feature] = stamp_;
  return true;
}

bool UniqueFeatures::take(const Correspondence& pair) {
  if (marked(scene_, pair.scene_feature) || marked(model_, pair.model_feature)) return false;
  return mark(scene_, pair.scene_feature) && mark(model_, pair.model_feature);
}

int UniqueFeatures::bound(const CorrespondenceSet& set, const std::vector<int>& members) {
  clear();
  int scene_features = 0, model_features = 0;
  for (const int i : members) {
    scene_features += mark(scene_, set.pair(i).scene_feature);
    model_features += mark(model_, set.pair(i).model_feature);
  }
  return std::min(scene_features, model_features);
}

}  // namespace rgbd_recognition
