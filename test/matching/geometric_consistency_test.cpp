#include "matching/geometric_consistency.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "matching/synthetic_scene.h"

namespace recognition {
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

/// A model feature at `place` whose keypoint points along x and is trained from z, seen by a camera that looks along z.
struct Facing {
  SceneFeatures scene;
  ModelFeatures model;

  void add(const Eigen::Vector3f& place, float turn) {
    Keypoint keypoint;
    keypoint.angle = turn;
    scene.image.keypoints.push_back(keypoint);
    scene.points.push_back(place + Eigen::Vector3f(0.0f, 0.0f, 10.0f));
    model.positions.push_back({place.x(), -place.y(), -place.z()});  // half a turn about x
    model.view_directions.push_back(Eigen::Vector3f::UnitZ());
    model.orientations.push_back(Eigen::Vector3f::UnitX());
  }

  std::vector<Eigen::Quaternionf> rotations(const std::vector<Correspondence>& pairs) const {
    return impliedRotations(pairs, featureFrames(scene), featureFrames(model));
  }
};

TEST(Consistency, OneCorrespondenceSuggestsTheRotation) {
  Facing facing;
  facing.add({0.0f, 0.0f, 0.0f}, 0.0f);
  facing.add({0.0f, 0.0f, 0.0f}, 0.5f);
  const auto rotations = facing.rotations({{0, 0, 0.0f}, {1, 1, 0.0f}});
  const Eigen::Quaternionf half_turn(Eigen::AngleAxisf(std::acos(-1.0f), Eigen::Vector3f::UnitX()));
  ASSERT_EQ(rotations.size(), 2u);
  EXPECT_LT(rotations[0].angularDistance(half_turn), 1e-3f);
  EXPECT_NEAR(rotations[1].angularDistance(half_turn), 0.5f, 1e-3f);
  facing.model.orientations.clear();
  EXPECT_TRUE(facing.rotations({{0, 0, 0.0f}}).empty());
}

TEST(Consistency, NormalsTellTheRotationFromAnyView) {
  // A feature on the plane z = 0 of the object, trained from straight above and seen from 40 degrees beside that.
  const Pose camera_from_object = [] {
    Pose pose = Pose::Identity();
    pose.linear() = (Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()) *
                     Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 0.0).normalized()))
                        .toRotationMatrix();
    pose.translation().z() = 1.0;
    return pose;
  }();
  ModelFeatures model;
  model.positions.push_back(Eigen::Vector3f::Zero());
  model.view_directions.push_back(Eigen::Vector3f::UnitZ());
  model.orientations.push_back(Eigen::Vector3f::UnitX());
  const std::vector<SurfacePoint> cloud = {{Eigen::Vector3f(0.001f, 0.0f, 0.0f), Eigen::Vector3f::UnitZ(), {}}};
  SceneFeatures scene;
  const Eigen::Vector3d along = camera_from_object.linear() * Eigen::Vector3d::UnitX();
  Keypoint keypoint;
  keypoint.angle = static_cast<float>(std::atan2(along.y(), along.x()));  // in the image's middle
  scene.image.keypoints.push_back(keypoint);
  scene.points.push_back({0.0f, 0.0f, 1.0f});
  const auto error = [&](const std::vector<SurfacePoint>& own) {
    const auto rotations = impliedRotations({{0, 0, 0.0f}}, featureFrames(scene), featureFrames(model, own));
    return rotations[0].angularDistance(Eigen::Quaternionf(camera_from_object.linear().cast<float>()));
  };
  EXPECT_GT(error({}), 0.5f);  // the views differ by so much
  scene.normals.push_back((camera_from_object.linear() * Eigen::Vector3d::UnitZ()).cast<float>());
  EXPECT_LT(error(cloud), 1e-3f);
}

TEST(Consistency, OtherRotationsAreNotConsistent) {
  Facing facing;
  const float degree = std::acos(-1.0f) / 180.0f;
  facing.add({0.0f, 0.0f, 0.0f}, 0.0f);
  facing.add({0.1f, 0.0f, 0.0f}, 40.0f * degree);
  facing.add({0.0f, 0.1f, 0.0f}, 60.0f * degree);
  const std::vector<Correspondence> pairs = {{0, 0, 0.1f}, {1, 1, 0.2f}, {2, 2, 0.3f}};
  const CorrespondenceSet set(pairs, facing.scene.points, facing.model.positions, facing.rotations(pairs));
  std::vector<int> consistent;
  set.findConsistent(0, {0.01, 50.0}, consistent);
  EXPECT_THAT(consistent, testing::ElementsAre(0, 1));
  set.findConsistent(0, {0.01, 180.0}, consistent);
  EXPECT_THAT(consistent, testing::ElementsAre(0, 1, 2));
}

TEST(Consistency, LinesTurnedAnotherWayAreNotConsistent) {
  Facing facing;
  facing.add({0.0f, 0.0f, 0.0f}, 0.0f);
  facing.add({0.1f, 0.0f, 0.0f}, 0.0f);
  facing.model.positions[1] = {-0.1f, 0.0f, 0.0f};  // as far, on the other side
  const std::vector<Correspondence> pairs = {{0, 0, 0.1f}, {1, 1, 0.2f}};
  const CorrespondenceSet set(pairs, facing.scene.points, facing.model.positions, facing.rotations(pairs));
  std::vector<int> consistent;
  set.findConsistent(0, {0.01, 50.0}, consistent);
  EXPECT_THAT(consistent, testing::ElementsAre(0));
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
  const int near = set.squaredResiduals(problem.camera_from_object, 1e-4f, residuals);
  ASSERT_EQ(residuals.size(), 37u);
  EXPECT_EQ(near, std::count_if(residuals.begin(), residuals.end(), [](float r) { return r <= 1e-4f; }));
  EXPECT_GE(near, problem.inliers);
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
}  // namespace recognition
