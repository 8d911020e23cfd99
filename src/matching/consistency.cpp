#include "rgbd_recognition/matching/consistency.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "rgbd_recognition/core/simd.h"

namespace rgbd_recognition {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

struct Points {
  const float* x;
  const float* y;
  const float* z;
};

/// One correspondence that the others are compared with.
struct Fixed {
  float scene[3];
  float model[3];
  float rotation[9];  // row by row
  float quaternion[4];
  float epsilon;         // of eq. (8)
  float least_cosine;    // of half the angle between the rotations
  float most_deviation;  // of the turned line, as a share of its length
};

RGBD_SIMD_CLONES void markEqualDistances(Points s, Points o, int count, const Fixed& f, std::uint8_t* consistent) {
  for (int i = 0; i < count; ++i) {
    const float sx = s.x[i] - f.scene[0], sy = s.y[i] - f.scene[1], sz = s.z[i] - f.scene[2];
    const float ox = o.x[i] - f.model[0], oy = o.y[i] - f.model[1], oz = o.z[i] - f.model[2];
    const float difference = std::sqrt(sx * sx + sy * sy + sz * sz) - std::sqrt(ox * ox + oy * oy + oz * oz);
    consistent[i] = std::fabs(difference) <= f.epsilon ? 1 : 0;
  }
}

RGBD_SIMD_CLONES void unmarkOtherTurns(Points s, Points o, Points q, const float* w, int count, const Fixed& f,
                                       std::uint8_t* consistent) {
  const float* r = f.rotation;
  for (int i = 0; i < count; ++i) {
    const float sx = s.x[i] - f.scene[0], sy = s.y[i] - f.scene[1], sz = s.z[i] - f.scene[2];
    const float ox = o.x[i] - f.model[0], oy = o.y[i] - f.model[1], oz = o.z[i] - f.model[2];
    const float dx = sx - (r[0] * ox + r[1] * oy + r[2] * oz);
    const float dy = sy - (r[3] * ox + r[4] * oy + r[5] * oz);
    const float dz = sz - (r[6] * ox + r[7] * oy + r[8] * oz);
    const float deviation = std::sqrt(dx * dx + dy * dy + dz * dz);
    const float allowed = f.epsilon + f.most_deviation * std::sqrt(sx * sx + sy * sy + sz * sz);
    const float cosine = std::fabs(q.x[i] * f.quaternion[0] + q.y[i] * f.quaternion[1] + q.z[i] * f.quaternion[2] +
                                   w[i] * f.quaternion[3]);
    consistent[i] &= static_cast<std::uint8_t>((cosine >= f.least_cosine) & (deviation <= allowed));
  }
}

RGBD_SIMD_CLONES void residualsOf(Points s, Points o, int count, const float* r, const float* t, float* residuals) {
  for (int i = 0; i < count; ++i) {
    const float dx = s.x[i] - (r[0] * o.x[i] + r[1] * o.y[i] + r[2] * o.z[i] + t[0]);
    const float dy = s.y[i] - (r[3] * o.x[i] + r[4] * o.y[i] + r[5] * o.z[i] + t[1]);
    const float dz = s.z[i] - (r[6] * o.x[i] + r[7] * o.y[i] + r[8] * o.z[i] + t[2]);
    residuals[i] = dx * dx + dy * dy + dz * dz;
  }
}

Points points(const std::array<std::vector<float>, 10>& columns, int first) {
  return {columns[first].data(), columns[first + 1].data(), columns[first + 2].data()};
}

/// Axes: along the orientation, across, towards the camera.
Eigen::Matrix3f featureFrame(const Eigen::Vector3f& orientation, const Eigen::Vector3f& towards_camera) {
  Eigen::Matrix3f frame;
  frame.col(2) = towards_camera.normalized();
  frame.col(1) = frame.col(2).cross(orientation).normalized();
  frame.col(0) = frame.col(1).cross(frame.col(2));
  return frame;
}

Fixed makeFixed(const CorrespondenceSet& set, int i, const ConsistencyLimits& limits) {
  Fixed fixed;
  const Eigen::Quaternionf rotation = set.rotation(i);
  Eigen::Map<Eigen::Vector3f>(fixed.scene) = set.scenePoint(i);
  Eigen::Map<Eigen::Vector3f>(fixed.model) = set.modelPoint(i);
  Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(fixed.rotation) = rotation.toRotationMatrix();
  Eigen::Map<Eigen::Vector4f>(fixed.quaternion) = rotation.coeffs();
  fixed.epsilon = static_cast<float>(limits.epsilon_g);
  fixed.least_cosine = static_cast<float>(std::cos(0.5 * limits.max_rotation * kDegree));
  fixed.most_deviation = static_cast<float>(2.0 * std::sin(0.5 * limits.max_rotation * kDegree));
  return fixed;
}

}  // namespace

std::vector<Eigen::Quaternionf> suggestedRotations(const std::vector<Correspondence>& pairs, const SceneFeatures& scene,
                                                   const ModelFeatures& model) {
  std::vector<Eigen::Quaternionf> rotations;
  if (model.orientations.empty() || model.view_directions.empty()) return rotations;
  for (const Correspondence& pair : pairs) {
    const float angle = scene.image.keypoints[pair.scene_feature].angle;
    const Eigen::Vector3f orientation(std::cos(angle), std::sin(angle), 0.0f);
    const Eigen::Matrix3f in_scene = featureFrame(orientation, -scene.points[pair.scene_feature]);
    const Eigen::Matrix3f on_model =
        featureFrame(model.orientations[pair.model_feature], model.view_directions[pair.model_feature]);
    rotations.emplace_back(Eigen::Matrix3f(in_scene * on_model.transpose()));
  }
  return rotations;
}

CorrespondenceSet::CorrespondenceSet(const std::vector<Correspondence>& pairs,
                                     const std::vector<Eigen::Vector3f>& scene_points,
                                     const std::vector<Eigen::Vector3f>& model_points,
                                     const std::vector<Eigen::Quaternionf>& rotations)
    : pairs_(pairs), oriented_(!rotations.empty()) {
  for (size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3f& scene = scene_points[pairs[i].scene_feature];
    const Eigen::Vector3f& model = model_points[pairs[i].model_feature];
    const Eigen::Vector4f rotation = oriented_ ? rotations[i].coeffs() : Eigen::Quaternionf::Identity().coeffs();
    for (int axis = 0; axis < 3; ++axis) {
      columns_[axis].push_back(scene[axis]);
      columns_[3 + axis].push_back(model[axis]);
    }
    for (int k = 0; k < 4; ++k) columns_[6 + k].push_back(rotation[k]);
  }
}

void CorrespondenceSet::assign(const CorrespondenceSet& from, const std::vector<int>& members) {
  oriented_ = from.oriented_;
  pairs_.clear();
  for (const int i : members) pairs_.push_back(from.pairs_[i]);
  for (size_t k = 0; k < columns_.size(); ++k) {
    columns_[k].clear();
    for (const int i : members) columns_[k].push_back(from.columns_[k][i]);
  }
}

void CorrespondenceSet::findConsistent(int fixed, const ConsistencyLimits& limits, std::vector<int>& consistent) const {
  static thread_local std::vector<std::uint8_t> marks;
  marks.resize(pairs_.size());
  const Fixed f = makeFixed(*this, fixed, limits);
  markEqualDistances(points(columns_, 0), points(columns_, 3), size(), f, marks.data());
  if (oriented_ && limits.max_rotation < 180.0)
    unmarkOtherTurns(points(columns_, 0), points(columns_, 3), points(columns_, 6), columns_[9].data(), size(), f,
                     marks.data());
  consistent.clear();
  for (int i = 0; i < size(); ++i) {
    if (!marks[i]) continue;
    const bool same_scene = pairs_[i].scene_feature == pairs_[fixed].scene_feature;
    const bool same_model = pairs_[i].model_feature == pairs_[fixed].model_feature;
    if (same_scene == same_model) consistent.push_back(i);  // both: `fixed` itself
  }
}

void CorrespondenceSet::squaredResiduals(const Pose& camera_from_object, std::vector<float>& residuals) const {
  residuals.resize(pairs_.size());
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> rotation = camera_from_object.linear().cast<float>();
  const Eigen::Vector3f translation = camera_from_object.translation().cast<float>();
  residualsOf(points(columns_, 0), points(columns_, 3), size(), rotation.data(), translation.data(), residuals.data());
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
