#include "matching/algorithm2.h"

#include <gtest/gtest.h>

#include "matching/synthetic_scene.h"

namespace recognition {
namespace {

/// As printed: n_r and Delta_d of Table III, nothing of ours; every correspondence may be fixed (the right ones are not
/// the nearest here).
MatchingParameters asPrinted() {
  MatchingParameters parameters;
  parameters.alpha = 1.0;
  parameters.beta = 1.0;
  parameters.min_filtered = 0;
  parameters.skip_explained = false;
  parameters.grow_consensus = false;
  return parameters;
}

PoseConsensus search(const synthetic::Problem& problem, const MatchingParameters& parameters, int must_beat = 4) {
  const CorrespondenceSet set(problem.pairs, problem.scene_points, problem.model_points);
  WorkBudget budget = WorkBudget::milliseconds(2000.0);
  return Algorithm2(parameters, 1).search(set, must_beat, budget);
}

int rightMembers(const synthetic::Problem& problem, const PoseConsensus& found) {
  int right = 0;
  for (const int member : found.members) right += problem.pairs[member].scene_feature < problem.inliers;
  return right;
}

class OutlierRatio : public testing::TestWithParam<double> {};

TEST_P(OutlierRatio, PoseIsFound) {
  std::mt19937 random(7);
  for (const MatchingParameters& parameters : {asPrinted(), MatchingParameters()}) {
    const auto problem = synthetic::makeProblem(GetParam() < 0.95 ? 200 : 1000, GetParam(), 0.002, random);
    MatchingParameters all_fixed = parameters;
    all_fixed.alpha = 1.0;
    const PoseConsensus found = search(problem, all_fixed);
    EXPECT_GE(rightMembers(problem, found), 0.9 * problem.inliers);
    EXPECT_LE(found.size(), 1.4 * problem.inliers + 2);
    EXPECT_LT(translationDistance(found.camera_from_object, problem.camera_from_object), 0.005);
    EXPECT_LT(rotationDistance(found.camera_from_object, problem.camera_from_object), 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(Ratios, OutlierRatio, testing::Values(0.0, 0.5, 0.8, 0.9, 0.95, 0.99));

TEST(Algorithm2, NothingFitsAmongOutliersOnly) {
  std::mt19937 random(8);
  EXPECT_EQ(search(synthetic::makeProblem(100, 1.0, 0.0, random), asPrinted(), 7).size(), 0);
  EXPECT_EQ(search(synthetic::makeProblem(2, 0.0, 0.0, random), asPrinted(), 0).size(), 0);
  EXPECT_EQ(search(synthetic::Problem(), asPrinted()).size(), 0);
}

TEST(Algorithm2, ManyWrongOnesInOnePlaceDoNotHideARightSet) {
  // 60 correspondences that all put the object in one place yet agree on no pose come first; 20 right ones last.
  std::mt19937 random(11);
  const synthetic::Problem right = synthetic::makeProblem(20, 0.0, 0.001, random);
  synthetic::Problem problem;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3f model = synthetic::randomPoint(0.1, random);
    problem.model_points.push_back(model);
    problem.scene_points.push_back(Eigen::Vector3f(0.0f, 0.0f, 2.0f) + model + synthetic::randomPoint(0.04, random));
    problem.pairs.push_back({i, i, 0.1f});
  }
  for (const Correspondence& pair : right.pairs) {
    problem.model_points.push_back(right.model_points[pair.model_feature]);
    problem.scene_points.push_back(right.scene_points[pair.scene_feature]);
    const int last = static_cast<int>(problem.model_points.size()) - 1;
    problem.pairs.push_back({last, last, 0.5f});
  }
  MatchingParameters parameters;
  parameters.epsilon_g = 0.05;  // so that the wrong ones are consistent with each other
  parameters.delta_d = 0.008;
  const PoseConsensus found = search(problem, parameters);
  EXPECT_GE(std::count_if(found.members.begin(), found.members.end(), [](int i) { return i >= 60; }), 18);
}

TEST(Algorithm2, PointsOnALineMakeNoConsensus) {
  synthetic::Problem problem;
  for (int i = 0; i < 20; ++i) {
    problem.model_points.push_back({0.01f * i, 0.0f, 0.0f});
    problem.scene_points.push_back({0.0f, 0.01f * i, 1.0f});
    problem.pairs.push_back({i, i, 0.1f});
  }
  EXPECT_EQ(search(problem, asPrinted()).size(), 0);
  EXPECT_EQ(search(problem, MatchingParameters()).size(), 0);
}

TEST(Algorithm2, RepeatedPairsCountOnce) {
  std::mt19937 random(9);
  auto problem = synthetic::makeProblem(6, 0.0, 0.0, random);
  const auto once = problem.pairs;
  for (int copy = 0; copy < 5; ++copy) problem.pairs.insert(problem.pairs.end(), once.begin(), once.end());
  EXPECT_EQ(search(problem, asPrinted()).size(), 6);
  EXPECT_EQ(search(problem, asPrinted(), 6).size(), 0);
}

/// `wrong` pairs that fit nothing, then 20 right ones, by rising distance.
synthetic::Problem wrongOnesFirst(int wrong) {
  std::mt19937 random(12);
  const auto right = synthetic::makeProblem(20, 0.0, 0.0, random);
  synthetic::Problem problem = right;
  problem.pairs.clear();
  for (int i = 0; i < wrong; ++i) {
    problem.pairs.push_back({static_cast<int>(problem.scene_points.size()),
                             static_cast<int>(problem.model_points.size()), 0.001f * static_cast<float>(i)});
    problem.scene_points.push_back({0.01f * static_cast<float>(i * i), 5.0f * static_cast<float>(i + 1), 9.0f});
    problem.model_points.push_back({0.0f, 0.0f, 0.3f});
  }
  for (int i = 0; i < 20; ++i) {
    problem.pairs.push_back(right.pairs[static_cast<size_t>(i)]);
    problem.pairs.back().distance = 0.5f + 0.001f * static_cast<float>(i);
  }
  return problem;
}

TEST(Algorithm2, AlphaLeavesTheOuterLoopTheSmallestDistances) {
  const auto problem = wrongOnesFirst(20);  // of 40, the first 20 are wrong
  MatchingParameters parameters = asPrinted();
  parameters.alpha = 0.5;  // T_alpha holds wrong ones alone
  EXPECT_EQ(search(problem, parameters).size(), 0);
  parameters.alpha = 0.51;  // ceil(20.4) = 21: the first right one is fixed, and T_2 is of T_f, not of T_alpha
  EXPECT_EQ(search(problem, parameters).size(), 20);
  parameters.alpha = 0.1;
  parameters.min_filtered = 21;  // ours: no fewer than these
  EXPECT_EQ(search(problem, parameters).size(), 20);
}

TEST(Algorithm2, BetaLeavesTheInnerLoopTheSmallestDistancesOfTheConsistent) {
  const auto problem = wrongOnesFirst(0);
  MatchingParameters parameters = asPrinted();
  parameters.beta = 0.5;
  const PoseConsensus found = search(problem, parameters);
  EXPECT_EQ(found.size(), 10);  // T_3 is of T_beta, ten of the twenty in T_2
  for (const int member : found.members) EXPECT_LT(member, 10);
  parameters.beta = 0.2;
  EXPECT_EQ(search(problem, parameters, 4).size(), 0);  // four: not more than must be beaten
  EXPECT_EQ(search(problem, parameters, 3).size(), 4);
}

TEST(Algorithm2, SameSeedSameResult) {
  std::mt19937 random(10);
  const auto problem = synthetic::makeProblem(300, 0.9, 0.004, random);
  const PoseConsensus a = search(problem, MatchingParameters()), b = search(problem, MatchingParameters());
  EXPECT_EQ(a.members, b.members);
  EXPECT_TRUE(a.camera_from_object.isApprox(b.camera_from_object, 0.0));
}

TEST(Algorithm2, BudgetBoundsTheWorstCase) {
  std::mt19937 random(11);  // one texture repeated: every pair of features looks alike
  auto problem = synthetic::makeProblem(80, 1.0, 0.0, random);
  problem.pairs.clear();
  for (int i = 0; i < 80; ++i)
    for (int j = 0; j < 80; ++j) problem.pairs.push_back({i, j, 0.1f});
  const CorrespondenceSet set(problem.pairs, problem.scene_points, problem.model_points);
  WorkBudget budget = WorkBudget::milliseconds(5.0);
  Algorithm2(asPrinted(), 1).search(set, 4, budget);
  EXPECT_TRUE(budget.exhausted());
  EXPECT_GT(budget.left, -WorkBudget::milliseconds(0.1).left);
}

}  // namespace
}  // namespace recognition
