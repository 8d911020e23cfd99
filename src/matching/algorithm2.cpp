#include "matching/algorithm2.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "matching/rigid_transform.h"

namespace recognition {
namespace {

constexpr double kMissedSample = 0.01;  // a RANSAC ends when a sample without outliers was missed with this probability
constexpr int kSampleWork = 40;         // units of WorkBudget: a sample drawn
constexpr int kTransformWork = 400;     // its transform
constexpr int kRotationWork = 60;       // a correspondence whose turn is tried
constexpr int kCollectWork = 200;       // a member of a consensus
constexpr double kRotationTolerance = 1.5;  // of Delta_d, as the two fixed have errors of their own
constexpr int kMinCrowded = 8;  // features of a consensus in a strip: a corner's few scales agree on any corner
constexpr double kRotationLever = 0.01;  // metres: errors of 3 mm in places against 0.3 rad in rotations
constexpr int kRefinements = 3;
constexpr int kClearConsensus = 25;
/// A correspondence is not fixed (as the first of Algorithm 2) if so many that are consistent with it gave nothing: the
/// tries of T_alpha would all go to one place of many wrong correspondences. Chosen by hand, other values not tried.
constexpr int kMaxFruitlessFixed = 3;
constexpr int kMaxFruitless = 12;  // triangles are drawn congruent, so most samples of a true set are right

/// RANSAC iterations after which a sample of 3 out of `inliers` among `count` was drawn.
int iterationsNeeded(int inliers, int count, int most) {
  const double good = std::pow(static_cast<double>(inliers) / count, 3);
  if (good >= 1.0 - kMissedSample) return 1;
  const double needed = std::ceil(std::log(kMissedSample) / std::log1p(-good));
  return needed < most ? static_cast<int>(needed) : most;
}

}  // namespace

int Algorithm2::filtered(int count, double fraction) const {
  const int share = static_cast<int>(std::ceil(fraction * count));
  return std::min(count, std::max(share, parameters_.min_filtered));
}

PoseConsensus Algorithm2::search(const CorrespondenceSet& set, int must_beat, WorkBudget& budget) {
  PoseConsensus best;
  explained_.assign(static_cast<size_t>(set.size()), 0);
  fruitless_.assign(static_cast<size_t>(set.size()), 0);
  int left = filtered(set.size(), parameters_.alpha);  // of T_alpha
  for (int first = 0; first < set.size() && left > 0 && !budget.exhausted(); ++first) {
    if (parameters_.skip_explained && fruitless_[first] >= kMaxFruitlessFixed) continue;
    --left;
    if (parameters_.skip_explained && explained_[first]) continue;
    const int before = best.size();
    searchFixed(set, first, must_beat, best, budget);
    if (isClear(best)) break;
    if (best.size() == before)
      for (const int other : consistent2_) ++fruitless_[other];
  }
  if (!best.members.empty()) refine(set, best);
  return best;
}

void Algorithm2::searchFixed(const CorrespondenceSet& set, int first, int must_beat, PoseConsensus& best,
                             WorkBudget& budget) {
  const auto to_beat = [&] { return std::max(must_beat, best.size()); };  // c_n
  set.findConsistent(first, limits_, consistent2_);                       // T_2
  budget.spend(3 * set.size());
  consistent2_.resize(static_cast<size_t>(filtered(static_cast<int>(consistent2_.size()), parameters_.beta)));
  if (unique_.bound(set, consistent2_) <= to_beat()) return;
  set_beta_.assign(set, consistent2_);  // T_beta
  graph_.reset(set_beta_, limits_);

  for (int second = 0; second < set_beta_.size() && !budget.exhausted(); ++second) {
    const int second_in_set = consistent2_[second];
    if (second_in_set == first) continue;
    if (parameters_.skip_explained && explained_[first] && explained_[second_in_set]) continue;
    const bool worthwhile = selectThird(set.places(first), second, to_beat(), budget);
    if (!worthwhile) continue;
    PoseConsensus found = ransac(consistent3_, graph_.row(second), to_beat(), budget);
    if (found.size() <= to_beat()) continue;
    for (int& member : found.members) member = consistent2_[member];
    best = std::move(found);
    markExplained(set, best);
    if (isClear(best)) return;
  }
}

/// So many correspondences do not agree by chance: a larger set is another instance, which the next search finds, or
/// the same, to which refine() grows this one.
bool Algorithm2::isClear(const PoseConsensus& consensus) const {
  return parameters_.grow_consensus && consensus.size() >= kClearConsensus;
}

void Algorithm2::markExplained(const CorrespondenceSet& set, const PoseConsensus& consensus) {
  if (!parameters_.skip_explained) return;
  const float limit = static_cast<float>(parameters_.delta_d * parameters_.delta_d);
  set.squaredResiduals(consensus.camera_from_object, limit, residuals_);
  for (int i = 0; i < set.size(); ++i) explained_[i] = residuals_[i] <= limit ? 1 : 0;
  for (const int member : consensus.members) explained_[member] = 1;
}

/// T_3; false if it cannot hold a consensus of more than `must_beat`.
bool Algorithm2::selectThird(const FeaturePlaces& first, int second, int must_beat, WorkBudget& budget) {
  const BitWord* row = graph_.row(second);
  const bool clique = countBits(row, graph_.words()) > must_beat && graph_.mayHoldClique(row, must_beat);
  budget.spend(graph_.takeWork());
  if (!clique) return false;
  consistent3_.clear();
  forEachBit(row, graph_.words(), [this](int i) { consistent3_.push_back(i); });
  set3_.assign(set_beta_, consistent3_);
  budget.spend(kRotationWork * set3_.size());
  const auto tolerance = static_cast<float>(kRotationTolerance * parameters_.delta_d);
  return set3_.rotateTogether(first, set_beta_.places(second), tolerance, must_beat, unique_);
}

PoseConsensus Algorithm2::ransac(const std::vector<int>& candidates, const BitWord* row, int must_beat,
                                 WorkBudget& budget) {
  PoseConsensus best;
  const int count = set3_.size();
  int most = must_beat;  // consensus so far
  int fruitless = 0;     // samples in a row that gave no larger one
  int iterations = iterationsNeeded(most, count, parameters_.ransac_iterations);
  for (int iteration = 0; iteration < iterations && !budget.exhausted(); ++iteration) {
    Pose pose;
    const int size = estimateFromSample(candidates, row, pose, budget) ? boundConsensus(set3_, pose, most) : 0;
    if (size <= most) {
      if (++fruitless == kMaxFruitless) break;
      continue;
    }
    fruitless = 0;
    most = size;
    best.camera_from_object = pose;
    iterations = iterationsNeeded(most, count, parameters_.ransac_iterations);
  }
  if (most == must_beat) return best;
  collectConsensus(set3_, best.camera_from_object, best.members);
  budget.spend(kCollectWork * best.size());
  if (best.size() <= must_beat || !estimate(set3_, best.members, best.camera_from_object)) best.members.clear();
  for (int& member : best.members) member = candidates[member];
  return best;
}

bool Algorithm2::estimateFromSample(const std::vector<int>& candidates, const BitWord* row, Pose& pose,
                                    WorkBudget& budget) {
  budget.spend(kSampleWork);
  int triangle[3];
  if (!graph_.drawTriangle(row, candidates, random_(), triangle)) return false;
  Triangle scene, model;
  for (int k = 0; k < 3; ++k) {
    scene[k] = set_beta_.scenePoint(triangle[k]);
    model[k] = set_beta_.modelPoint(triangle[k]);
  }
  budget.spend(kTransformWork + set3_.size());
  const auto estimated = triangleTransform(model, scene, parameters_.min_spread);
  if (!estimated && !mayUseRotations(set_beta_, set3_.size())) return false;
  pose = estimated ? *estimated
                   : meanTransform(model, scene,
                                   {set_beta_.rotation(triangle[0]), set_beta_.rotation(triangle[1]),
                                    set_beta_.rotation(triangle[2])});
  return true;
}

bool Algorithm2::estimate(const CorrespondenceSet& set, const std::vector<int>& members, Pose& pose) {
  source_.clear();
  target_.clear();
  for (const int i : members) {
    source_.push_back(set.modelPoint(i).cast<double>());
    target_.push_back(set.scenePoint(i).cast<double>());
  }
  auto estimated = rigidTransform(source_, target_, parameters_.min_spread);
  if (!estimated && mayUseRotations(set, static_cast<int>(members.size()))) {
    rotations_.clear();
    for (const int i : members) rotations_.push_back(set.rotation(i));
    estimated = rigidTransform(source_, target_, rotations_, kRotationLever);
  }
  if (estimated) pose = *estimated;
  return estimated.has_value();
}

/// Whether the rotations that so many correspondences propose by themselves may stand in where their places leave one
/// open: a strip of a label, seen edge-on. Ours, as max_rotation is.
bool Algorithm2::mayUseRotations(const CorrespondenceSet& set, int count) const {
  return set.oriented() && !limits_.any_rotation && count >= kMinCrowded;
}

int Algorithm2::boundConsensus(const CorrespondenceSet& set, const Pose& pose, int must_beat) {
  const float limit = static_cast<float>(parameters_.delta_d * parameters_.delta_d);
  inliers_.clear();
  if (set.squaredResiduals(pose, limit, residuals_) <= must_beat) return 0;
  for (int i = 0; i < set.size(); ++i)
    if (residuals_[i] <= limit) inliers_.push_back(i);  // eq. (9)
  return unique_.bound(set, inliers_);
}

void Algorithm2::collectConsensus(const CorrespondenceSet& set, const Pose& pose, std::vector<int>& members) {
  boundConsensus(set, pose, 0);
  std::sort(inliers_.begin(), inliers_.end(),
            [this](int a, int b) { return residuals_[a] != residuals_[b] ? residuals_[a] < residuals_[b] : a < b; });
  unique_.clear();
  members.clear();
  for (const int i : inliers_)
    if (unique_.take(set.pair(i))) members.push_back(i);
}

void Algorithm2::refine(const CorrespondenceSet& set, PoseConsensus& consensus) {
  if (!parameters_.grow_consensus) return;
  PoseConsensus grown;
  Pose pose = consensus.camera_from_object;
  for (int i = 0; i < kRefinements; ++i) {
    collectConsensus(set, pose, grown.members);
    if (grown.size() < consensus.size() || !estimate(set, grown.members, grown.camera_from_object)) return;
    consensus = grown;
    pose = grown.camera_from_object;
  }
}

}  // namespace recognition
