#include "matching/rigid_transform.h"

#include <gtest/gtest.h>

#include "matching/synthetic_scene.h"

namespace recognition {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points randomPoints(int count, std::mt19937& random) {
  Points points;
  for (int i = 0; i < count; ++i) points.push_back(synthetic::randomPoint(0.1, random).cast<double>());
  return points;
}

Points transformed(const Points& points, const Pose& pose) {
  Points result;
  for (const Eigen::Vector3d& point : points) result.push_back(pose * point);
  return result;
}

TEST(RigidTransform, RecoversAKnownPose) {
  std::mt19937 random(1);
  for (const int count : {3, 4, 50}) {
    const Points source = randomPoints(count, random);
    const Pose expected = synthetic::randomPose(random);
    const auto pose = rigidTransform(source, transformed(source, expected), 0.001);
    ASSERT_TRUE(pose);
    EXPECT_LT(rotationDistance(*pose, expected), 1e-7);
    EXPECT_LT(translationDistance(*pose, expected), 1e-9);
  }
}

TEST(RigidTransform, QuarterTurnByHand) {
  const Points source = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Points target = {{5, 1, 0}, {4, 0, 0}, {5, 0, 1}};  // 90 degrees about z, then +5 in x
  const auto pose = rigidTransform(source, target, 0.001);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(rotationDistance(Pose::Identity(), *pose), std::acos(-1.0) / 2.0, 1e-7);
  EXPECT_LT((pose->translation() - Eigen::Vector3d(5, 0, 0)).norm(), 1e-9);
}

TEST(RigidTransform, NeverReflects) {
  std::mt19937 random(2);
  const Points source = randomPoints(20, random);
  Points mirrored = source;
  for (Eigen::Vector3d& point : mirrored) point.x() = -point.x();
  const auto pose = rigidTransform(source, mirrored, 0.001);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->linear().determinant(), 1.0, 1e-9);
}

TEST(RigidTransform, PlanarPointsAreEnough) {
  std::mt19937 random(3);
  Points source = randomPoints(10, random);
  for (Eigen::Vector3d& point : source) point.z() = 0.0;
  const Pose expected = synthetic::randomPose(random);
  const auto pose = rigidTransform(source, transformed(source, expected), 0.001);
  ASSERT_TRUE(pose);
  EXPECT_LT(rotationDistance(*pose, expected), 1e-7);
}

TEST(RigidTransform, PointsOnALineGiveNothing) {
  std::mt19937 random(4);
  Points source;
  for (int i = 0; i < 10; ++i) source.push_back({0.02 * i, 0.01 * i, 0.0});
  EXPECT_FALSE(rigidTransform(source, transformed(source, synthetic::randomPose(random)), 0.001));
  EXPECT_FALSE(rigidTransform(Points(5, Eigen::Vector3d::Ones()), Points(5, Eigen::Vector3d::Zero()), 0.0));
  EXPECT_FALSE(rigidTransform(randomPoints(2, random), randomPoints(2, random), 0.0));
}

TEST(RigidTransform, DifferentNumbersThrow) {
  std::mt19937 random(5);
  EXPECT_THROW(rigidTransform(randomPoints(4, random), randomPoints(5, random), 0.001), std::invalid_argument);
}

TEST(TriangleTransform, IsTheLeastSquaresOne) {
  std::mt19937 random(6);
  for (int i = 0; i < 100; ++i) {
    const Pose moved = synthetic::randomPose(random);
    Triangle source, target;
    for (int k = 0; k < 3; ++k) {
      source[k] = synthetic::randomPoint(0.1, random);
      target[k] = moved.cast<float>() * source[k] + synthetic::randomPoint(0.01, random);
    }
    const auto toDouble = [](const Triangle& t) {
      return Points{t[0].cast<double>(), t[1].cast<double>(), t[2].cast<double>()};
    };
    const auto expected = rigidTransform(toDouble(source), toDouble(target), 0.005);
    const auto pose = triangleTransform(source, target, 0.005);
    ASSERT_EQ(pose.has_value(), expected.has_value());
    if (!pose) continue;
    EXPECT_LT(rotationDistance(*pose, *expected), 1e-4);
    EXPECT_LT(translationDistance(*pose, *expected), 1e-5);
  }
}

TEST(TriangleTransform, PointsOnALineGiveNothing) {
  const Triangle line = {Eigen::Vector3f(0, 0, 1), {0.1f, 0, 1}, {0.2f, 0, 1}}, twice = {line[0], line[0], line[1]};
  EXPECT_FALSE(triangleTransform(line, line, 0.001));
  EXPECT_FALSE(triangleTransform(twice, twice, 0.0));
}

TEST(RigidTransform, RotationsStandInForPointsOnALine) {
  std::mt19937 random(9);
  const Pose expected = synthetic::randomPose(random);
  Points source;
  for (int i = 0; i < 10; ++i) source.emplace_back(0.01 * i, 0.0, 0.0);
  const Points target = transformed(source, expected);
  EXPECT_FALSE(rigidTransform(source, target, 0.001));
  const std::vector<Eigen::Quaternionf> rotations(10, Eigen::Quaternionf(expected.linear().cast<float>()));
  const auto pose = rigidTransform(source, target, rotations, 0.01);
  ASSERT_TRUE(pose);
  EXPECT_LT(rotationDistance(*pose, expected), 1e-5);
  EXPECT_LT(translationDistance(*pose, expected), 1e-6);
  EXPECT_FALSE(rigidTransform({}, {}, {}, 0.01));
  EXPECT_THROW(rigidTransform(source, target, {}, 0.01), std::invalid_argument);
}

TEST(RigidTransform, MeanOfATrianglesRotations) {
  std::mt19937 random(10);
  const Pose expected = synthetic::randomPose(random);
  const Triangle source = {Eigen::Vector3f(0.0f, 0.0f, 0.0f), Eigen::Vector3f(0.01f, 0.0f, 0.0f),
                           Eigen::Vector3f(0.03f, 0.0f, 0.0f)};
  Triangle target;
  for (size_t i = 0; i < 3; ++i) target[i] = (expected * source[i].cast<double>()).cast<float>();
  const Eigen::Quaternionf own(expected.linear().cast<float>());
  const Pose pose = meanTransform(source, target, {own, Eigen::Quaternionf(-own.coeffs()), own});  // one rotation
  EXPECT_LT(rotationDistance(pose, expected), 1e-5);
  EXPECT_LT(translationDistance(pose, expected), 1e-5);
}

}  // namespace
}  // namespace recognition
