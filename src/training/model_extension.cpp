#include "training/model_extension.h"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "matching/rigid_transform.h"
#include "training/feature_merging.h"
#include "meshes/surface_sampling.h"
#include "training/cloud_finder.h"
#include "training/model_overlap.h"
#include "training/object_hull.h"
#include "training/small_motion.h"
#include "training/turned_over.h"

namespace recognition {
namespace {

constexpr int kMaxFeatures = 3000;        // of each model that are compared: those seen in most views
constexpr float kMatchRatio = 0.85f;      // of the distances to the nearest and the next descriptor elsewhere
constexpr int kNeighbours = 6;            // descriptors, of which the next may be of the same place
constexpr int kMaxPoses = 4;              // of each kind of features that are tried
constexpr int kSamples = 3000;            // of RANSAC
constexpr double kAgreement = 0.008;      // metres between places of one feature
constexpr int kMinAgreeing = 15;          // features; fewer may agree by chance
constexpr double kMinSpread = 0.005;      // metres, of three features that make a pose
constexpr double kMinCorrelation = 0.35;  // of one texture's brightness in two models
constexpr int kAlignmentRounds = 15;
constexpr float kAlignmentReach = 0.012f;  // metres, farthest pairing
constexpr double kMaxResidual = 0.004;     // metres; beyond, the surfaces are not the same
constexpr double kMaxContradicted = 0.01;
constexpr double kContradictedInClearPrint =
    0.04;                                 // handles, propellers and edges of shoes; a wrong turn: 9 % and more
constexpr double kContactWeight = 10.0;   // of all that touches what it stood on, in pairs, where features agree
constexpr double kContactShare = 0.2;     // of it in the surface's points, where few do
constexpr double kTurnStep = 20.0;        // degrees, of an object on its head
constexpr size_t kTurnPoints = 1500;      // that align it at first
constexpr double kNearTurn = 0.015;       // metres between places of one feature before they align it
constexpr double kClearPrint = 0.7;       // correlation with which features are right
constexpr double kMinTurned = 0.2;        // of the correlation
constexpr double kFreeShare = 0.05;       // of what holds the second least held motion: what shape leaves free
constexpr double kFreeLever = 0.05;       // metres
constexpr double kFreeStep = 0.0005;      // metres
constexpr int kFreeSteps = 20;            // to either side
constexpr double kMinGain = 0.1;          // of the correlation; less, and it is as likely to lead away
constexpr double kOtherTurn = 0.5;        // radians
constexpr double kMinLead = 0.2;          // of the correlation over that of other turns
constexpr float kSheetDistance = 0.004f;  // metres between the sheets that the two make of one surface
constexpr float kMinDistance = 0.72f;     // least distance of points, in spacings

struct Pairs {
  std::vector<Eigen::Vector3d> from, to;

  // Those that agree with a pose, or those that do not.
  Pairs within(const Pose& to_from, double distance, bool agree = true) const {
    Pairs some;
    for (size_t i = 0; i < from.size(); ++i)
      if (((to_from * from[i] - to[i]).norm() < distance) == agree)
        some.from.push_back(from[i]), some.to.push_back(to[i]);
    return some;
  }
};

Pairs matchFeatures(const ModelFeatures& model, const ModelFeatures& addition) {
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_L2)
      .knnMatch(unitDescriptors(addition.descriptors.rowRange(0, std::min(kMaxFeatures, addition.count()))),
                unitDescriptors(model.descriptors.rowRange(0, std::min(kMaxFeatures, model.count()))), matches,
                kNeighbours);
  const auto place = [&](const cv::DMatch& match) { return model.positions[static_cast<size_t>(match.trainIdx)]; };
  Pairs pairs;
  for (const auto& nearest : matches) {
    const auto next = std::find_if(nearest.begin(), nearest.end(), [&](const cv::DMatch& match) {
      return (place(match) - place(nearest[0])).norm() > kAgreement;
    });
    if (next == nearest.end() ? nearest.size() < 2 : nearest[0].distance > kMatchRatio * next->distance) continue;
    pairs.from.push_back(addition.positions[static_cast<size_t>(nearest[0].queryIdx)].cast<double>());
    pairs.to.push_back(model.positions[static_cast<size_t>(nearest[0].trainIdx)].cast<double>());
  }
  return pairs;
}

// RANSAC over samples of three pairs whose distances agree.
Pairs largestConsensus(const Pairs& pairs) {
  cv::RNG rng(7);
  Pairs best;
  const int count = static_cast<int>(pairs.from.size());
  for (int sample = 0; count >= 3 && sample < kSamples; ++sample) {
    Pairs three;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<size_t>(rng.uniform(0, count));
      three.from.push_back(pairs.from[i]), three.to.push_back(pairs.to[i]);
    }
    bool rigid = true;
    for (size_t k = 0; k < 3; ++k)
      rigid = rigid && std::abs((three.from[k] - three.from[(k + 1) % 3]).norm() -
                                (three.to[k] - three.to[(k + 1) % 3]).norm()) < kAgreement;
    const auto pose = rigid ? rigidTransform(three.from, three.to, kMinSpread) : std::nullopt;
    if (!pose) continue;
    Pairs agreeing = pairs.within(*pose, kAgreement);
    if (agreeing.from.size() > best.from.size()) best = std::move(agreeing);
  }
  return best;
}

// What the object stood on ends it: as much as features tell, so that a base that was not measured whole does no harm.
void addContacts(const ObjectModel& model, const ObjectModel& addition, const Pose& pose, double weight,
                 SmallMotion& motion) {
  SmallMotion touch;
  touch.centre = motion.centre;
  for (const Contact& contact : contactsOf(model, addition, pose))
    touch.addPair(contact.from.cast<double>(), contact.to);
  if (touch.pairs <= 0.0) return;
  motion.a += weight / touch.pairs * touch.a;
  motion.b += weight / touch.pairs * touch.b;
}

// Adds the addition's cloud, paired with the model's. Returns the pairs' distances from its planes, metres.
std::vector<double> addClouds(const CloudFinder& finder, const ObjectModel& addition, const Pose& model_from_addition,
                              SmallMotion& motion) {
  const Eigen::Isometry3f pose(model_from_addition.cast<float>());
  std::vector<double> distances;
  for (const SurfacePoint& point : addition.cloud) {
    const Eigen::Vector3f p = pose * point.position;
    if (const SurfacePoint* pair = finder.nearest(p, pose.linear() * point.normal))
      distances.push_back(motion.addPair(p.cast<double>(), *pair));
  }
  return distances;
}

// Point-to-plane steps of the addition's cloud to the model's, and of its features to their pairs: those hold what
// shape leaves free, as a can's turn.
// `contact_weight`: of all that touches a plane, in pairs.
void refine(const ObjectModel& model, const ObjectModel& addition, const Pairs& pairs, double contact_weight,
            ModelFit& fit) {
  const CloudFinder finder(model.cloud, kAlignmentReach);
  for (int round = 0; round <= kAlignmentRounds; ++round) {
    SmallMotion motion;
    motion.centre = fit.model_from_addition.translation();
    std::vector<double> distances = addClouds(finder, addition, fit.model_from_addition, motion);
    if (distances.empty()) throw std::runtime_error("the new views show no surface of the model");
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    fit.residual = *middle;
    if (round == kAlignmentRounds) return;
    for (size_t i = 0; i < pairs.from.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        motion.addPair(fit.model_from_addition * pairs.from[i],
                       {pairs.to[i].cast<float>(), Eigen::Vector3f::Unit(axis), {}});
    addContacts(model, addition, fit.model_from_addition, contact_weight, motion);
    fit.model_from_addition = motion.solve() * fit.model_from_addition;
  }
}

// Too much of the surface lies where the other was seen to have nothing.
bool isContradicted(const ModelFit& fit) {
  return fit.contradicted > (fit.correlation < kClearPrint ? kMaxContradicted : kContradictedInClearPrint);
}

// Throws if the pose cannot be.
void check(const ObjectModel& model, const ObjectModel& addition, ModelFit& fit) {
  if (fit.residual > kMaxResidual)
    throw std::runtime_error("the new views' surface lies " + std::to_string(1000.0 * fit.residual) +
                             " mm from the model's: another object?");
  fit.correlation = textureCorrelation(model, addition, fit.model_from_addition);
  if (fit.correlation < kMinCorrelation)
    throw std::runtime_error("the texture of the new views is not the model's (correlation " +
                             std::to_string(fit.correlation) + "): another object?");
  fit.contradicted = contradictedShare(model, addition, fit.model_from_addition);
  if (isContradicted(fit))
    throw std::runtime_error("the new views fit the model in part only: " + std::to_string(100.0 * fit.contradicted) +
                             " % of the surface lies where the others saw none; too little texture to tell how the "
                             "object stood, or another object?");
}

// Throws if the poses that the pairs agree on cannot be.
ModelFit fitTo(const ObjectModel& model, const ObjectModel& addition, const Pairs& pairs) {
  ModelFit fit;
  fit.features = static_cast<int>(pairs.from.size());
  const auto pose = rigidTransform(pairs.from, pairs.to, kMinSpread);
  if (fit.features < kMinAgreeing || !pose)
    throw std::runtime_error("only " + std::to_string(fit.features) +
                             " features of the new views agree with the model: another object, or too little overlap");
  fit.model_from_addition = *pose;
  refine(model, addition, pairs, kContactWeight, fit);
  check(model, addition, fit);
  return fit;
}

// Where shape leaves one motion free, as a can's rotation: that along it with which the textures agree clearly better.
// Features would tell it better, if there are enough.
void slideToPrint(const ObjectModel& model, const ObjectModel& addition, ModelFit& fit) {
  const Pose start = fit.model_from_addition;
  SmallMotion motion;
  for (const SurfacePoint& point : addition.cloud)
    motion.centre += start * point.position.cast<double>() / static_cast<double>(addition.cloud.size());
  addClouds(CloudFinder(model.cloud, kAlignmentReach), addition, start, motion);
  addContacts(model, addition, start, kContactShare * static_cast<double>(addition.cloud.size()), motion);
  const auto free = motion.freeMotion(kFreeLever, kFreeShare);
  ModelFit best = fit;
  for (int k = -kFreeSteps; free && k <= kFreeSteps; ++k) {
    const Pose pose = motion.motionBy(kFreeStep * k * *free) * start;
    const double correlation = textureCorrelation(model, addition, pose);
    if (correlation > best.correlation) best.correlation = correlation, best.model_from_addition = pose;
  }
  if (best.correlation <= fit.correlation + kMinGain) return;
  best.contradicted = contradictedShare(model, addition, best.model_from_addition);
  if (!isContradicted(best)) fit = best;
}

// The object on its head: only a rotation about the vertical is to be found. Either its shape leaves one, or its texture is
// clearly better with one than with all others. Nothing if neither is so.
std::optional<ModelFit> fitTurnedOver(const ObjectModel& model, const ObjectModel& addition, const Pairs& all) {
  ObjectModel some = addition;
  some.cloud.clear();
  const size_t stride = 1 + addition.cloud.size() / kTurnPoints;
  for (size_t i = 0; i < addition.cloud.size(); i += stride) some.cloud.push_back(addition.cloud[i]);
  const double contact_weight = kContactShare * static_cast<double>(some.cloud.size());
  std::vector<ModelFit> fits;
  for (const Pose& start : turnedOverPoses(model, addition, kTurnStep)) {
    ModelFit fit;
    fit.model_from_addition = start;
    try {
      refine(model, some, {}, contact_weight, fit);
      refine(model, some, all.within(fit.model_from_addition, kNearTurn), contact_weight, fit);
    } catch (const std::runtime_error&) {  // no surface of the one is near the other's
      continue;
    }
    if (fit.residual > kMaxResidual) continue;
    fit.correlation = textureCorrelation(model, addition, fit.model_from_addition);
    fit.contradicted = contradictedShare(model, addition, fit.model_from_addition);
    if (!isContradicted(fit)) fits.push_back(fit);
  }
  if (fits.empty()) return std::nullopt;
  ModelFit best = *std::max_element(fits.begin(), fits.end(),
                                    [](const ModelFit& a, const ModelFit& b) { return a.correlation < b.correlation; });
  double least = 0.0;  // a texture that speaks against it
  for (const ModelFit& fit : fits)
    if (rotationDistance(fit.model_from_addition, best.model_from_addition) > kOtherTurn)
      least = std::max({least, kMinTurned, fit.correlation + kMinLead});
  if (best.correlation < least) return std::nullopt;
  const auto agreeing = [&] { return static_cast<int>(all.within(best.model_from_addition, kAgreement).from.size()); };
  if (agreeing() < kMinAgreeing) slideToPrint(model, addition, best);
  best.features = agreeing();
  return best;
}

}  // namespace

// A texture that is on the object twice agrees with several poses: each is tried.
ModelFit fitModels(const ObjectModel& model, const ObjectModel& addition, Stand stand) {
  std::optional<ModelFit> best;
  std::string reason = "the two models share no kind of features";
  int most = -1;  // features behind the reason
  Pairs all;
  for (const auto& [type, features] : model.features) {
    const auto other = addition.features.find(type);
    if (other == addition.features.end() || features.count() < 2 || other->second.count() < 2) continue;
    Pairs pairs = matchFeatures(features, other->second);
    all.from.insert(all.from.end(), pairs.from.begin(), pairs.from.end());
    all.to.insert(all.to.end(), pairs.to.begin(), pairs.to.end());
    for (int k = 0; k < kMaxPoses; ++k) {
      const Pairs agreeing = largestConsensus(pairs);
      try {
        const ModelFit fit = fitTo(model, addition, agreeing);
        if (stand == Stand::kTurnedOver && !isTurnedOver(model, moved(addition, fit.model_from_addition)))
          throw std::runtime_error("by its texture, the object was not turned over");
        if (!best || fit.features * fit.correlation > best->features * best->correlation) best = fit;
      } catch (const std::runtime_error& error) {
        if (static_cast<int>(agreeing.from.size()) > most) reason = error.what();
        most = std::max(most, static_cast<int>(agreeing.from.size()));
      }
      const auto pose = rigidTransform(agreeing.from, agreeing.to, kMinSpread);
      if (static_cast<int>(agreeing.from.size()) < kMinAgreeing || !pose) break;
      pairs = pairs.within(*pose, 2.0 * kAgreement, false);
    }
  }
  if (!best || best->correlation < kClearPrint) {
    const auto over = fitTurnedOver(model, addition, all);
    if (over && (!best || over->correlation > best->correlation)) best = over;
  }
  if (!best) throw std::runtime_error(reason);
  return *best;
}

ObjectModel extendModel(const ObjectModel& model, const ObjectModel& addition, const RecordingParameters& parameters,
                        Stand stand) {
  const ModelFit fit = fitModels(model, addition, stand);
  const ObjectModel added = moved(addition, fit.model_from_addition);
  ObjectModel extended = model;
  extended.cloud.insert(extended.cloud.end(), added.cloud.begin(), added.cloud.end());
  extended.cloud = thinMeasuredSurface(extended.cloud, std::vector<float>(extended.cloud.size(), 1.0f),
                                       kMinDistance * static_cast<float>(parameters.point_spacing), kSheetDistance);
  extended.rest_planes.insert(extended.rest_planes.end(), added.rest_planes.begin(), added.rest_planes.end());
  if (isWhole(extended))
    extended.extents = computeEvenExtents(extended.cloud, static_cast<float>(parameters.point_spacing));
  for (auto& [type, features] : extended.features) {
    const auto other = added.features.find(type);
    if (other != added.features.end()) features = mergeFeatures({features, other->second}, parameters.merging);
  }
  return extended;
}

}  // namespace recognition
