#include "rgbd_recognition/training/model_extension.h"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <stdexcept>

#include "rgbd_recognition/core/point_grid.h"
#include "rgbd_recognition/matching/rigid_transform.h"
#include "rgbd_recognition/model/feature_merging.h"
#include "rgbd_recognition/model/surface_sampling.h"
#include "small_motion.h"

namespace rgbd_recognition {
namespace {

constexpr int kMostFeatures = 3000;         // of each model that are compared: those seen in most views
constexpr float kMatchRatio = 0.85f;        // of the distances to the nearest and the next descriptor elsewhere
constexpr int kSamples = 3000;              // of RANSAC
constexpr double kAgreement = 0.008;        // metres between places of one feature
constexpr int kLeastAgreeing = 15;          // features; fewer may agree by chance
constexpr double kLeastSpread = 0.005;      // metres, of three features that make a pose
constexpr float kSamePlace = 0.003f;        // metres between points whose colours are compared
constexpr double kLeastCorrelation = 0.35;  // of one print's brightness in two models
constexpr int kAlignmentRounds = 15;
constexpr float kAlignmentReach = 0.012f;   // metres, farthest pairing
constexpr double kLargestResidual = 0.004;  // metres; beyond, the surfaces are not the same
constexpr float kThinning = 0.72f;          // least distance of points, in spacings

struct Pairs {
  std::vector<Eigen::Vector3d> from, to;

  Pairs within(const Pose& to_from, double distance) const {
    Pairs agreeing;
    for (size_t i = 0; i < from.size(); ++i)
      if ((to_from * from[i] - to[i]).norm() < distance) agreeing.from.push_back(from[i]), agreeing.to.push_back(to[i]);
    return agreeing;
  }
};

Pairs matchFeatures(const ModelFeatures& model, const ModelFeatures& addition) {
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_L2)
      .knnMatch(unitDescriptors(addition.descriptors.rowRange(0, std::min(kMostFeatures, addition.count()))),
                unitDescriptors(model.descriptors.rowRange(0, std::min(kMostFeatures, model.count()))), matches, 2);
  Pairs pairs;
  for (const auto& nearest : matches) {
    if (nearest.size() < 2 || nearest[0].distance > kMatchRatio * nearest[1].distance) continue;
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
    const auto pose = rigid ? rigidTransform(three.from, three.to, kLeastSpread) : std::nullopt;
    if (!pose) continue;
    Pairs agreeing = pairs.within(*pose, kAgreement);
    if (agreeing.from.size() > best.from.size()) best = std::move(agreeing);
  }
  return best;
}

PointGrid gridOf(const ObjectModel& model) {
  PointGrid grid(kAlignmentReach);
  for (size_t i = 0; i < model.cloud.size(); ++i) grid.insert(model.cloud[i].position, static_cast<int>(i));
  return grid;
}

// The cloud's point nearest to p whose normal agrees, or null.
const SurfacePoint* nearest(const std::vector<SurfacePoint>& cloud, const PointGrid& grid, const Eigen::Vector3f& p,
                            const Eigen::Vector3f& normal) {
  const SurfacePoint* best = nullptr;
  float best_distance = kAlignmentReach * kAlignmentReach;
  grid.forNeighbours(p, [&](int i) {
    const SurfacePoint& point = cloud[static_cast<size_t>(i)];
    const float d = (point.position - p).squaredNorm();
    if (d >= best_distance || point.normal.dot(normal) < 0.7f) return;
    best_distance = d;
    best = &point;
  });
  return best;
}

// Point-to-plane steps of the addition's cloud to the model's.
void refine(const ObjectModel& model, const ObjectModel& addition, ModelFit& fit) {
  const PointGrid grid = gridOf(model);
  for (int round = 0; round <= kAlignmentRounds; ++round) {
    const Eigen::Isometry3f pose(fit.model_from_addition.cast<float>());
    SmallMotion motion;
    motion.centre = fit.model_from_addition.translation();
    std::vector<double> distances;
    for (const SurfacePoint& point : addition.cloud) {
      const Eigen::Vector3f p = pose * point.position;
      if (const SurfacePoint* pair = nearest(model.cloud, grid, p, pose.linear() * point.normal))
        distances.push_back(motion.addPair(p.cast<double>(), *pair));
    }
    if (distances.empty()) throw std::runtime_error("the new views show no surface of the model");
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    fit.residual = *middle;
    if (round < kAlignmentRounds) fit.model_from_addition = motion.solve() * fit.model_from_addition;
  }
}

float brightness(const SurfacePoint& point) {
  return static_cast<float>(point.rgb[0]) + static_cast<float>(point.rgb[1]) + static_cast<float>(point.rgb[2]);
}

// Correlation of the brightness of the two clouds where they overlap: whatever the light was, one print is bright and
// dark in the same places. Objects of one shape with different prints agree in their edges' features, and not in this.
double printCorrelation(const ObjectModel& model, const ObjectModel& addition, const Pose& model_from_addition) {
  const PointGrid grid = gridOf(model);
  const Eigen::Isometry3f pose(model_from_addition.cast<float>());
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  for (const SurfacePoint& point : addition.cloud) {
    const SurfacePoint* pair = nearest(model.cloud, grid, pose * point.position, pose.linear() * point.normal);
    if (!pair || (pose * point.position - pair->position).norm() > kSamePlace) continue;
    const double a = brightness(point), b = brightness(*pair);
    n += 1.0, x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
  }
  const double spread = (n * xx - x * x) * (n * yy - y * y);
  return spread > 0.0 ? (n * xy - x * y) / std::sqrt(spread) : 0.0;
}

}  // namespace

ModelFit fitModels(const ObjectModel& model, const ObjectModel& addition) {
  Pairs best;
  for (const auto& [type, features] : model.features) {
    const auto other = addition.features.find(type);
    if (other == addition.features.end() || features.count() < 2 || other->second.count() < 2) continue;
    Pairs agreeing = largestConsensus(matchFeatures(features, other->second));
    if (agreeing.from.size() > best.from.size()) best = std::move(agreeing);
  }
  ModelFit fit;
  fit.features = static_cast<int>(best.from.size());
  const auto pose = rigidTransform(best.from, best.to, kLeastSpread);
  if (fit.features < kLeastAgreeing || !pose)
    throw std::runtime_error("only " + std::to_string(fit.features) +
                             " features of the new views agree with the model: another object, or too little overlap");
  fit.model_from_addition = *pose;
  refine(model, addition, fit);
  if (fit.residual > kLargestResidual)
    throw std::runtime_error("the new views' surface lies " + std::to_string(1000.0 * fit.residual) +
                             " mm from the model's: another object?");
  const double correlation = printCorrelation(model, addition, fit.model_from_addition);
  if (correlation < kLeastCorrelation)
    throw std::runtime_error("the print of the new views is not the model's (correlation " +
                             std::to_string(correlation) + "): another object?");
  return fit;
}

ObjectModel extendModel(const ObjectModel& model, const ObjectModel& addition, const RecordingParameters& parameters) {
  const ModelFit fit = fitModels(model, addition);
  const ObjectModel added = moved(addition, fit.model_from_addition);
  ObjectModel extended = model;
  extended.cloud.insert(extended.cloud.end(), added.cloud.begin(), added.cloud.end());
  extended.cloud = thinSurface(extended.cloud, kThinning * static_cast<float>(parameters.point_spacing));
  extended.extents = computeExtents(extended.cloud);
  for (auto& [type, features] : extended.features) {
    const auto other = added.features.find(type);
    if (other != added.features.end()) features = mergeFeatures({features, other->second}, parameters.merging);
  }
  return extended;
}

}  // namespace rgbd_recognition
