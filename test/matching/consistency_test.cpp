#include "rgbd_recognition/matching/consistency.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "matching/synthetic_scene.h"

namespace rgbd_recognition {
namespace {

/// Scene points at 0, 0.1, 0.1 + gap and again 0.1 along x; model points at 0, 0.1, 0.1, 0.1.
CorrespondenceSet line(float gap) {
  const std::vector<Eigen::Vector3f> scene = {{0, 0, 1}, {0.1f, 0, 1}, {0.1f + gap, 0, 1}};
  const std::vector<Eigen::Vector3f> model = {{0, 0, 0}, {0, 0.1f, 0}, {0, 0.1f, 0}};
  return CorrespondenceSet({{0, 0, 0.1f}, {1, 1, 0.2f}, {2, 2, 0.3f}}, scene, model);
}

TEST(Consistency, Equation8HoldsWithinEpsilon) {
  std::vector<int> consistent;
  const CorrespondenceSet near = line(0.009f), far = line(0.011f);
  near.findConsistent(0, {0.010}, consistent);
  EXPECT_THAT(consistent, testing::ElementsAre(0, 1, 2));
  far.findConsistent(0, {0.010}, consistent);
  EXPECT_THAT(consistent, testing::ElementsAre(0, 1));
}

TEST(Consistency, Equation8IsBlindToPose) {
  std::mt19937 random(1);
  const auto problem = synthetic::makeProblem(40, 0.0, 0.0, random);
  const CorrespondenceSet set(problem.pairs, problem.scene_points, problem.model_points);
  std::vector<int> consistent;
  set.findConsistent(7, {0.0001}, consistent);
  EXPECT_EQ(consistent.size(), 40u);
}

TEST(Consistency, PairsThatShareOneFeatureAreNotConsistent) {
  const std::vector<Eigen::Vector3f> points = {{0, 0, 1}, {0.001f, 0, 1}};
  const CorrespondenceSet set({{0, 0, 0.1f}, {0, 1, 0.2f}, {1, 0, 0.3f}, {1, 1, 0.4f}}, points, points);
  std::vector<int> consistent;
  set.findConsistent(0, {0.01}, consistent);
  EXPECT_THAT(consistent, testing::ElementsAre(0, 3));
}

TEST(Consistency, Equation9ResidualsAgreeWithEigen) {
  std::mt19937 random(2);
  const auto problem = synthetic::makeProblem(37, 0.5, 0.002, random);
  const CorrespondenceSet set(problem.pairs, problem.scene_points, problem.model_points);
  std::vector<float> residuals;
  set.squaredResiduals(problem.camera_from_object, residuals);
  ASSERT_EQ(residuals.size(), 37u);
  for (int i = 0; i < set.size(); ++i) {
    const Eigen::Vector3d predicted = problem.camera_from_object * set.modelPoint(i).cast<double>();
    EXPECT_NEAR(std::sqrt(residuals[i]), (predicted - set.scenePoint(i).cast<double>()).norm(), 1e-5);
  }
}

TEST(UniqueFeatures, EachFeatureIsTakenOnce) {
  UniqueFeatures unique;
  for (int selection = 0; selection < 2; ++selection) {
    unique.clear();
    EXPECT_TRUE(unique.take({3, 5, 0.0f}));
    EXPECT_FALSE(unique.take({3, 6, 0.0f}));
    EXPECT_FALSE(unique.take({4, 5, 0.0f}));
    EXPECT_TRUE(unique.take({4, 6, 0.0f}));
  }
  const std::vector<Eigen::Vector3f> points(4, Eigen::Vector3f::UnitZ());
  const CorrespondenceSet set({{0, 0, 0.0f}, {0, 1, 0.0f}, {0, 2, 0.0f}, {1, 3, 0.0f}}, points, points);
  EXPECT_EQ(unique.bound(set, {0, 1, 2, 3}), 2);
  EXPECT_EQ(unique.bound(set, {0}), 1);
}

}  // namespace
}  // namespace rgbd_recognition
