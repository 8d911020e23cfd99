#include "matching/geometric_consistency.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/angles.h"
#include "core/point_grid.h"
#include "core/simd.h"

namespace recognition {
namespace {

constexpr int kStretch = 1024;  // correspondences whose marks stay in the first-level cache
constexpr size_t kPlaceColumns = 6;
constexpr int kMaxRotations = 512;
constexpr float kMinFacing = 0.26f;      // cosine of 75 degrees between a normal and the view
constexpr float kNormalRadius = 0.006f;  // metres from a feature to the cloud's point that lends its normal

struct Points {
  const float* x;
  const float* y;
  const float* z;
};

/// One correspondence that the others are compared with.
struct Fixed {
  float scene[3];
  float model[3];
  std::int32_t scene_feature, model_feature;
  float epsilon;  // of eq. (8)
};

/// Features of the correspondences.
struct Features {
  const std::int32_t* scene;
  const std::int32_t* model;
};

/// Eq. (8) without its roots: with squared distances A and B, |sqrt(A) - sqrt(B)| <= epsilon where A + B - epsilon^2 <=
/// 2 sqrt(A B).
RGBD_SIMD_CLONES void markEqualDistances(Points s, Points o, Features features, int count, const Fixed& f,
                                         std::uint8_t* consistent) {
  const float squared_epsilon = f.epsilon * f.epsilon;
  for (int i = 0; i < count; ++i) {
    const float sx = s.x[i] - f.scene[0], sy = s.y[i] - f.scene[1], sz = s.z[i] - f.scene[2];
    const float ox = o.x[i] - f.model[0], oy = o.y[i] - f.model[1], oz = o.z[i] - f.model[2];
    const float in_scene = sx * sx + sy * sy + sz * sz, on_model = ox * ox + oy * oy + oz * oz;
    const float excess = in_scene + on_model - squared_epsilon;
    const bool equal = (excess <= 0.0f) | (excess * excess <= 4.0f * in_scene * on_model);
    const bool shared = (features.scene[i] == f.scene_feature) | (features.model[i] == f.model_feature);
    consistent[i] = static_cast<std::uint8_t>(equal & !shared);
  }
}

/// Rotations that correspondences propose, as quaternions.
struct Rotations {
  const float* x;
  const float* y;
  const float* z;
  const float* w;
};

/// What the fixed correspondence proposes about the others' rotations and lines.
struct FixedRotation {
  float quaternion[4];  // x y z w
  float matrix[9];      // row by row
  float min_cosine, max_deviation;
};

/// Takes the marks of those that propose another rotation, or whose line is not turned into the scene's. The latter
/// without roots: its deviation D is at most epsilon + m l where D^2 - epsilon^2 - m^2 l^2 <= 2 epsilon m l.
RGBD_SIMD_CLONES void unmarkOtherRotations(Points s, Points o, Rotations q, int count, const Fixed& fixed,
                                           const FixedRotation& turn, std::uint8_t* consistent) {
  const Fixed f = fixed;
  const FixedRotation t = turn;  // copies, as what the marks are written to is none of them
  const float* r = t.matrix;
  const float squared_epsilon = f.epsilon * f.epsilon, squared_most = t.max_deviation * t.max_deviation;
  for (int i = 0; i < count; ++i) {
    const float cosine =
        q.x[i] * t.quaternion[0] + q.y[i] * t.quaternion[1] + q.z[i] * t.quaternion[2] + q.w[i] * t.quaternion[3];
    const float sx = s.x[i] - f.scene[0], sy = s.y[i] - f.scene[1], sz = s.z[i] - f.scene[2];
    const float ox = o.x[i] - f.model[0], oy = o.y[i] - f.model[1], oz = o.z[i] - f.model[2];
    const float dx = sx - (r[0] * ox + r[1] * oy + r[2] * oz);
    const float dy = sy - (r[3] * ox + r[4] * oy + r[5] * oz);
    const float dz = sz - (r[6] * ox + r[7] * oy + r[8] * oz);
    const float line = squared_most * (sx * sx + sy * sy + sz * sz);
    const float excess = dx * dx + dy * dy + dz * dz - squared_epsilon - line;
    const bool turned = (excess <= 0.0f) | (excess * excess <= 4.0f * squared_epsilon * line);
    const bool same = (cosine >= t.min_cosine) | (cosine <= -t.min_cosine);
    consistent[i] = static_cast<std::uint8_t>(consistent[i] & static_cast<std::uint8_t>(same & turned));
  }
}

/// Marks of 0 or 1 as bits; `marks` to the end of the last word.
void packBits(const std::uint8_t* marks, int words, BitWord* bits) {
  constexpr BitWord kGather = 0x0102040810204080;  // moves the lowest bits of eight bytes into the highest byte
  for (int w = 0; w < words; ++w) {
    bits[w] = 0;
    for (int byte = 0; byte < 8; ++byte, marks += 8) {
      BitWord eight;
      std::memcpy(&eight, marks, sizeof(eight));
      bits[w] |= ((eight * kGather) >> 56) << (8 * byte);
    }
  }
}

RGBD_SIMD_CLONES int residualsOf(Points s, Points o, int count, const float* r, const float* t, float limit,
                                 float* residuals) {
  int within = 0;
  for (int i = 0; i < count; ++i) {
    const float dx = s.x[i] - (r[0] * o.x[i] + r[1] * o.y[i] + r[2] * o.z[i] + t[0]);
    const float dy = s.y[i] - (r[3] * o.x[i] + r[4] * o.y[i] + r[5] * o.z[i] + t[1]);
    const float dz = s.z[i] - (r[6] * o.x[i] + r[7] * o.y[i] + r[8] * o.z[i] + t[2]);
    residuals[i] = dx * dx + dy * dy + dz * dz;
    within += residuals[i] <= limit ? 1 : 0;
  }
  return within;
}

/// The line through two points, and two directions across it.
struct Axis {
  Eigen::Vector3f origin, along, across, other;

  Axis(const Eigen::Vector3f& from, const Eigen::Vector3f& to)
      : origin(from), along((to - from).normalized()), across(along.unitOrthogonal()), other(along.cross(across)) {}
};

/// Correspondences about two fixed ones: a turn t (unit, complex) leaves the squared distance apart - 2 Re(t* turn).
struct Turns {
  float apart[kMaxRotations];
  float real[kMaxRotations], imaginary[kMaxRotations];  ///< of turn
  BitWord feature[kMaxRotations];                       ///< the scene feature's bit
};

RGBD_SIMD_CLONES void rotationsAbout(const Axis& in_scene, const Axis& on_model, Points s, Points o, int count,
                                     Turns& turns) {
  const Axis a = in_scene, b = on_model;
  for (int i = 0; i < count; ++i) {
    const float sx = s.x[i] - a.origin[0], sy = s.y[i] - a.origin[1], sz = s.z[i] - a.origin[2];
    const float ox = o.x[i] - b.origin[0], oy = o.y[i] - b.origin[1], oz = o.z[i] - b.origin[2];
    const float sr = sx * a.across[0] + sy * a.across[1] + sz * a.across[2];
    const float si = sx * a.other[0] + sy * a.other[1] + sz * a.other[2];
    const float onr = ox * b.across[0] + oy * b.across[1] + oz * b.across[2];
    const float oni = ox * b.other[0] + oy * b.other[1] + oz * b.other[2];
    const float shift =
        sx * a.along[0] + sy * a.along[1] + sz * a.along[2] - (ox * b.along[0] + oy * b.along[1] + oz * b.along[2]);
    turns.apart[i] = sr * sr + si * si + onr * onr + oni * oni + shift * shift;
    turns.real[i] = sr * onr + si * oni;
    turns.imaginary[i] = si * onr - sr * oni;
  }
}

/// Whether the turn of one of them brings more than `least` scene features within the squared distance `limit`. The loop
/// over the turns is in here, as bits are counted by an instruction only where a clone may use it.
RGBD_SIMD_CLONES bool anyRotationHolds(const Turns& turns, int count, float limit, int least) {
  for (int k = 0; k < count; ++k) {
    const float length = std::sqrt(turns.real[k] * turns.real[k] + turns.imaginary[k] * turns.imaginary[k]);
    if (!(length > 0.0f)) continue;
    const float real = turns.real[k] / length, imaginary = turns.imaginary[k] / length;
    BitWord features = 0;
    for (int i = 0; i < count; ++i) {
      const float apart = turns.apart[i] - 2.0f * (real * turns.real[i] + imaginary * turns.imaginary[i]);
      features |= apart <= limit ? turns.feature[i] : 0;
    }
    if (__builtin_popcountll(features) > least) return true;
  }
  return false;
}

Points points(const std::array<std::vector<float>, 10>& columns, int axis, int first = 0) {
  return {columns[axis].data() + first, columns[axis + 1].data() + first, columns[axis + 2].data() + first};
}

Rotations rotations(const std::array<std::vector<float>, 10>& columns, int first) {
  const auto column = [&](size_t k) { return columns[kPlaceColumns + k].data() + first; };
  return {column(0), column(1), column(2), column(3)};
}

/// `orientation`: of the image, across the way to the camera; it is moved along that way onto the surface.
Eigen::Quaternionf featureFrame(const Eigen::Vector3f& orientation, const Eigen::Vector3f& towards_camera,
                                const Eigen::Vector3f& normal) {
  const Eigen::Vector3f view = towards_camera.normalized();
  const float facing = normal.dot(view);
  const bool steep = !(facing > kMinFacing);
  Eigen::Matrix3f frame;
  frame.col(2) = steep ? view : normal;
  const Eigen::Vector3f on_surface = steep ? orientation : orientation - orientation.dot(normal) / facing * view;
  frame.col(1) = frame.col(2).cross(on_surface).normalized();
  frame.col(0) = frame.col(1).cross(frame.col(2));
  return Eigen::Quaternionf(frame);
}

/// Normal of the cloud's point nearest to a place, of those that look towards the camera.
Eigen::Vector3f nearestNormal(const PointGrid& grid, const std::vector<SurfacePoint>& cloud,
                              const Eigen::Vector3f& place, const Eigen::Vector3f& towards_camera) {
  float nearest = kNormalRadius * kNormalRadius;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  grid.forNeighbours(place, [&](int i) {
    const SurfacePoint& point = cloud[static_cast<size_t>(i)];
    const float distance = (point.position - place).squaredNorm();
    if (distance >= nearest || point.normal.dot(towards_camera) <= 0.0f) return;
    nearest = distance;
    normal = point.normal;
  });
  return normal;
}

Fixed makeFixed(const CorrespondenceSet& set, int i, const ConsistencyLimits& limits) {
  Fixed fixed;
  Eigen::Map<Eigen::Vector3f>(fixed.scene) = set.scenePoint(i);
  Eigen::Map<Eigen::Vector3f>(fixed.model) = set.modelPoint(i);
  fixed.scene_feature = set.pair(i).scene_feature;
  fixed.model_feature = set.pair(i).model_feature;
  fixed.epsilon = limits.epsilon;
  return fixed;
}

FixedRotation makeFixedRotation(const Eigen::Quaternionf& rotation, const ConsistencyLimits& limits) {
  FixedRotation turn;
  Eigen::Map<Eigen::Vector4f>(turn.quaternion) = rotation.coeffs();
  Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(turn.matrix) = rotation.toRotationMatrix();
  turn.min_cosine = limits.min_cosine;
  turn.max_deviation = limits.max_deviation;
  return turn;
}

}  // namespace

std::vector<Eigen::Quaternionf> featureFrames(const SceneFeatures& scene) {
  std::vector<Eigen::Quaternionf> frames;
  frames.reserve(scene.points.size());
  for (size_t i = 0; i < scene.points.size(); ++i) {
    const float angle = scene.image.keypoints[i].angle;
    const Eigen::Vector3f normal = scene.normals.empty() ? Eigen::Vector3f(0.0f, 0.0f, 0.0f) : scene.normals[i];
    frames.push_back(featureFrame({std::cos(angle), std::sin(angle), 0.0f}, -scene.points[i], normal));
  }
  return frames;
}

std::vector<Eigen::Quaternionf> featureFrames(const ModelFeatures& model, const std::vector<SurfacePoint>& cloud) {
  PointGrid grid(kNormalRadius);
  for (size_t i = 0; i < cloud.size(); ++i) grid.insert(cloud[i].position, static_cast<int>(i));
  std::vector<Eigen::Quaternionf> frames;
  frames.reserve(model.orientations.size());
  for (size_t i = 0; i < std::min(model.orientations.size(), model.view_directions.size()); ++i) {
    const Eigen::Vector3f& view = model.view_directions[i];
    frames.push_back(featureFrame(model.orientations[i], view, nearestNormal(grid, cloud, model.positions[i], view)));
  }
  return frames;
}

std::vector<Eigen::Quaternionf> impliedRotations(const std::vector<Correspondence>& pairs,
                                                 const std::vector<Eigen::Quaternionf>& scene_frames,
                                                 const std::vector<Eigen::Quaternionf>& model_frames) {
  std::vector<Eigen::Quaternionf> rotations;
  if (model_frames.empty()) return rotations;
  rotations.reserve(pairs.size());
  for (const Correspondence& pair : pairs)
    rotations.push_back(scene_frames[pair.scene_feature] * model_frames[pair.model_feature].conjugate());
  return rotations;
}

ConsistencyLimits::ConsistencyLimits(double epsilon_g, double max_rotation)
    : epsilon(static_cast<float>(epsilon_g)),
      any_rotation(max_rotation >= 180.0),
      min_cosine(static_cast<float>(std::cos(0.5 * max_rotation * kDegree))),
      max_deviation(static_cast<float>(2.0 * std::sin(0.5 * max_rotation * kDegree))) {}

CorrespondenceSet::CorrespondenceSet(const std::vector<Correspondence>& pairs,
                                     const std::vector<Eigen::Vector3f>& scene_points,
                                     const std::vector<Eigen::Vector3f>& model_points,
                                     const std::vector<Eigen::Quaternionf>& rotations)
    : pairs_(pairs), oriented_(!rotations.empty()) {
  for (size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3f& scene = scene_points[pairs[i].scene_feature];
    const Eigen::Vector3f& model = model_points[pairs[i].model_feature];
    scene_features_.push_back(pairs[i].scene_feature);
    model_features_.push_back(pairs[i].model_feature);
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
  const auto gather = [&members](const auto& source, auto& target) {
    target.resize(members.size());
    for (size_t i = 0; i < members.size(); ++i) target[i] = source[members[i]];
  };
  gather(from.pairs_, pairs_);
  gather(from.scene_features_, scene_features_);
  gather(from.model_features_, model_features_);
  for (size_t k = 0; k < (oriented_ ? columns_.size() : kPlaceColumns); ++k) gather(from.columns_[k], columns_[k]);
}

void CorrespondenceSet::markConsistent(int fixed, const ConsistencyLimits& limits, BitWord* consistent) const {
  const Fixed f = makeFixed(*this, fixed, limits);
  const bool turns = oriented_ && !limits.any_rotation;
  FixedRotation turn;
  if (turns) turn = makeFixedRotation(rotation(fixed), limits);
  alignas(64) std::uint8_t marks[kStretch];
  for (int first = 0; first < size(); first += kStretch) {
    const int count = std::min(kStretch, size() - first);
    const Features features{scene_features_.data() + first, model_features_.data() + first};
    const Points scene = points(columns_, 0, first), model = points(columns_, 3, first);
    markEqualDistances(scene, model, features, count, f, marks);
    if (turns) unmarkOtherRotations(scene, model, rotations(columns_, first), count, f, turn, marks);
    std::fill(marks + count, marks + wordsFor(count) * kWordBits, std::uint8_t{0});
    packBits(marks, wordsFor(count), consistent + first / kWordBits);
  }
  consistent[fixed / kWordBits] |= BitWord{1} << (fixed % kWordBits);
}

void CorrespondenceSet::findConsistent(int fixed, const ConsistencyLimits& limits, std::vector<int>& consistent) const {
  std::vector<BitWord> bits(static_cast<size_t>(wordsFor(size())));
  markConsistent(fixed, limits, bits.data());
  consistent.clear();
  forEachBit(bits.data(), wordsFor(size()), [&](int i) { consistent.push_back(i); });
}

bool CorrespondenceSet::rotateTogether(const FeaturePlaces& first, const FeaturePlaces& second, float tolerance,
                                       int least, UniqueFeatures& unique) const {
  if (size() > kMaxRotations || least >= kWordBits) return true;
  Turns turns;
  unique.clear();
  for (int i = 0; i < size(); ++i) turns.feature[i] = BitWord{1} << (unique.note(pairs_[i]) % kWordBits);
  if (unique.bound() <= least) return false;
  if (unique.sceneFeatures() > kWordBits) return true;  // their bits would coincide
  rotationsAbout(Axis(first.scene, second.scene), Axis(first.model, second.model), points(columns_, 0),
                 points(columns_, 3), size(), turns);
  return anyRotationHolds(turns, size(), tolerance * tolerance, least);
}

int CorrespondenceSet::squaredResiduals(const Pose& camera_from_object, float limit,
                                        std::vector<float>& residuals) const {
  residuals.resize(pairs_.size());
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> rotation = camera_from_object.linear().cast<float>();
  const Eigen::Vector3f translation = camera_from_object.translation().cast<float>();
  return residualsOf(points(columns_, 0), points(columns_, 3), size(), rotation.data(), translation.data(), limit,
                     residuals.data());
}

int UniqueFeatures::Numbers::add(int feature, int stamp) {
  if (feature >= static_cast<int>(stamps.size())) {
    stamps.resize(feature + 1, 0);
    numbers.resize(feature + 1, 0);
  }
  if (stamps[feature] == stamp) return numbers[feature];
  stamps[feature] = stamp;
  return numbers[feature] = count++;
}

bool UniqueFeatures::take(const Correspondence& pair) {
  if (scene_.has(pair.scene_feature, stamp_) || model_.has(pair.model_feature, stamp_)) return false;
  note(pair);
  return true;
}

int UniqueFeatures::note(const Correspondence& pair) {
  model_.add(pair.model_feature, stamp_);
  return scene_.add(pair.scene_feature, stamp_);
}

int UniqueFeatures::bound(const CorrespondenceSet& set, const std::vector<int>& members) {
  clear();
  for (const int i : members) note(set.pair(i));
  return bound();
}

}  // namespace recognition
