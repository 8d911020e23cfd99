#include "matching/pose_support.h"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace recognition {
namespace {

/// `good` pairs that agree with one pose and `bad` ones that propose quite other rotations.
struct Problem {
  std::vector<Correspondence> pairs;
  std::vector<Eigen::Quaternionf> rotations;
  std::vector<Eigen::Vector3f> scene, model;

  Problem(int good, int bad) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-0.1f, 0.1f);
    const Eigen::Quaternionf truth(Eigen::AngleAxisf(0.7f, Eigen::Vector3f(1, 2, 2) / 3.0f));
    for (int i = 0; i < good + bad; ++i) {
      model.emplace_back(uniform(random), uniform(random), uniform(random));
      scene.push_back(truth * model.back() + Eigen::Vector3f(0.1f, 0.0f, 1.0f));
      pairs.push_back({i, i, 0.1f});
      const Eigen::Vector3f axis = Eigen::Vector3f(uniform(random), uniform(random), uniform(random)).normalized();
      const Eigen::Quaternionf wrong(Eigen::AngleAxisf(2.0f + 10.0f * uniform(random), axis));  // 1 to 3 radians off
      rotations.push_back(i < good ? truth : truth * wrong);
    }
  }

  std::vector<int> support() const { return poseSupport(pairs, rotations, scene, model, 0.05, 30.0); }
};

TEST(PoseSupport, PairsOfOnePoseSupportOneAnother) {
  const Problem problem(12, 0);
  EXPECT_THAT(problem.support(), testing::Each(11));
}

TEST(PoseSupport, WrongOnesScatter) {
  const Problem problem(20, 200);
  const std::vector<int> support = problem.support();
  for (int i = 0; i < 20; ++i) EXPECT_GE(support[i], 19) << i;
  EXPECT_LT(*std::max_element(support.begin() + 20, support.end()), 19);
}

TEST(PoseSupport, OneSceneFeatureCountsOnce) {
  Problem problem(6, 0);
  for (Correspondence& pair : problem.pairs) pair.scene_feature = 0;
  problem.scene.assign(6, problem.scene.front());
  problem.model.assign(6, problem.model.front());
  EXPECT_THAT(problem.support(), testing::Each(0));
}

TEST(PoseSupport, SortKeepsEqualOnesInOrder) {
  const std::vector<Correspondence> pairs = {{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {3, 3, 0}};
  std::vector<int> order;
  for (const Correspondence& pair : sortBySupport(pairs, {1, 5, 1, 5})) order.push_back(pair.scene_feature);
  EXPECT_THAT(order, testing::ElementsAre(1, 3, 0, 2));
}

TEST(PoseSupport, NoPairsNoSupport) { EXPECT_TRUE(poseSupport({}, {}, {}, {}, 0.05, 30.0).empty()); }

}  // namespace
}  // namespace recognition
