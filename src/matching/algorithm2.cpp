#include "rgbd_recognition/matching/algorithm2.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "rgbd_recognition/matching/rigid_transform.h"

namespace rgbd_recognition {
namespace {

constexpr double kMissedSample = 0.01;  // a RANSAC ends when a sample without outliers was missed with this probability
constexpr int kTransformWork = 2500;    // units of WorkBudget
constexpr int kRefinements = 3;

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
  const int alpha_count = filtered(set.size(), parameters_.alpha);  // |T_alpha|
  for (int first = 0; first < alpha_count && !budget.exhausted(); ++first)
    if (!parameters_.skip_explained || !explained_[first]) searchFixed(set, first, must_beat, best, budget);
  if (!best.members.empty()) refine(set, best);
  return best;
}

void Algorithm2::searchFixed(const CorrespondenceSet& set, int first, int must_beat, PoseConsensus& best,
                             WorkBudget& budget) {
  const auto to_beat = [&] { return std::max(must_beat, best.size()); };  // c_n
  set.findConsistent(first, limits_, consistent2_);                       // T_2
  budget.spend(2 * set.size());
  consistent2_.resize(static_cast<size_t>(filtered(static_cast<int>(consistent2_.size()), parameters_.beta)));
  if (unique_.bound(set, consistent2_) <= to_beat()) return;
  set_beta_.assign(set, consistent2_);  // T_beta

  for (int second = 0; second < set_beta_.size() && !budget.exhausted(); ++second) {
    const int second_in_set = consistent2_[second];
    if (second_in_set == first) continue;
    if (parameters_.skip_explained && explained_[first] && explained_[second_in_set]) continue;
    set_beta_.findConsistent(second, limits_, consistent3_);  // T_3
    budget.spend(2 * set_beta_.size() + 10 * static_cast<int>(consistent3_.size()));
    if (unique_.bound(set_beta_, consistent3_) <= to_beat()) continue;
    PoseConsensus found = ransac(set_beta_, consistent3_, to_beat(), budget);
    if (found.size() <= to_beat()) continue;
    for (int& member : found.members) member = consistent2_[member];
    best = std::move(found);
    std::fill(explained_.begin(), explained_.end(), std::uint8_t{0});
    for (const int member : best.members) explained_[member] = 1;
  }
}

PoseConsensus Algorithm2::ransac(const CorrespondenceSet& set, const std::vector<int>& candidates, int must_beat,
                                 WorkBudget& budget) {
  PoseConsensus best;
  set3_.assign(set, candidates);
  const int count = set3_.size();
  const int bound = unique_.bound(set, candidates);
  int iterations = iterationsNeeded(must_beat, count, parameters_.ransac_iterations);
  std::vector<int> sample(3), members;
  for (int iteration = 0; iteration < iterations && !budget.exhausted(); ++iteration) {
    for (int& member : sample) member = static_cast<int>(random_() % static_cast<unsigned>(count));
    budget.spend(kTransformWork + 8 * count);
    Pose pose;
    if (!estimate(set3_, sample, pose)) continue;
    collectConsensus(set3_, pose, members);
    if (static_cast<int>(members.size()) <= std::max(must_beat, best.size())) continue;
    best.members = members;
    best.camera_from_object = pose;
    if (best.size() == bound) break;
    iterations = iterationsNeeded(best.size(), count, parameters_.ransac_iterations);
  }
  if (!best.members.empty() && !estimate(set3_, best.members, best.camera_from_object)) best.members.clear();
  for (int& member : best.members) member = candidates[member];
  return best;
}

bool Algorithm2::estimate(const CorrespondenceSet& set, const std::vector<int>& members, Pose& pose) {
  source_.clear();
  target_.clear();
  for (const int i : members) {
    source_.push_back(set.modelPoint(i).cast<double>());
    target_.push_back(set.scenePoint(i).cast<double>());
  }
  const auto estimated = rigidTransform(source_, target_, parameters_.min_spread);
  if (estimated) pose = *estimated;
  return estimated.has_value();
}

void Algorithm2::collectConsensus(const CorrespondenceSet& set, const Pose& pose, std::vector<int>& members) {
  set.squaredResiduals(pose, residuals_);
  const float limit = static_cast<float>(parameters_.delta_d * parameters_.delta_d);
  inliers_.clear();
  for (int i = 0; i < set.size(); ++i)
    if (residuals_[i] <= limit) inliers_.push_back(i);  // eq. (9)
  std::stable_sort(inliers_.begin(), inliers_.end(), [this](int a, int b) { return residuals_[a] < residuals_[b]; });
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

}  // namespace rgbd_recognition
