#include <cmath>

#include <gtest/gtest.h>

#include "search/frame_search.h"
#include "alignment/any_threads.h"
#include "alignment/synthetic_scene.h"
#include "rgbd_recognition/matching/scene_matches.h"
#include "alignment/prepared_model.h"

namespace recognition {
namespace {

using synthetic::poseAt;

/// A box and a can that stand on a table. Nothing matches them but one wrong pair each.
class RestingProposals : public ::testing::Test {
 protected:
  RestingProposals()
      : models_{synthetic::makeModel(synthetic::box(1), "box"), synthetic::makeModel(synthetic::can(2), "can")},
        placed_{standing(synthetic::box(1), -0.12, 25.0), standing(synthetic::can(2), 0.12, 70.0), table()} {
    parameters_.correspondence_proposals = 0;
    matches_.by_object = {{{0, 0, 0.5f}}, {{1, 1, 0.5f}}};
  }

  /// y of the table's frame points into it.
  static Pose cameraFromTable() {
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(0.0, 0.05, 0.95);
    pose.linear() = Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitX()).toRotationMatrix();
    return pose;
  }

  static synthetic::Placed standing(const synthetic::Solid& solid, double x, double degrees) {
    Pose table_from_object = Pose::Identity();
    table_from_object.translation() = Eigen::Vector3d(x, -solid.half.y(), 0.0);
    table_from_object.linear() = Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
    return {solid, cameraFromTable() * table_from_object};
  }

  static synthetic::Placed table() {
    synthetic::Solid slab = synthetic::box(3);
    slab.half = {0.5, 0.01, 0.3};
    slab.texture = [](const Eigen::Vector3d&) { return cv::Vec3b(150, 140, 120); };
    Pose table_from_slab = Pose::Identity();
    table_from_slab.translation().y() = slab.half.y();
    return {slab, cameraFromTable() * table_from_slab};
  }

  std::vector<VerifiedHypothesis> find(bool plane = true) {
    ObjectModel featureless;
    featureless.features[DescriptorType::kSurf128] = {};
    scene_ = synthetic::render(placed_, {models_[0], models_[1], featureless}, {});
    if (plane) scene_->segmentation.labels.setTo(kLargePlane, scene_->instance == 2);
    for (int v = 0; v < scene_->instance.rows && specks_; v += 9)
      for (int u = 0; u < scene_->instance.cols; u += 9)
        if (scene_->instance.at<int>(v, u) == 2) scene_->segmentation.labels.at<int>(v, u) = 0;
    scene_->segmentation.patches.pop_back();
    const ModelDatabase database = synthetic::databaseOf(models_);
    FrameSearch search(parameters_, database, scene_->view);
    search.run({}, 0, &matches_);
    return search.detections();
  }

  std::vector<ObjectModel> models_;
  std::vector<synthetic::Placed> placed_;
  std::unique_ptr<synthetic::Scene> scene_;
  SceneMatches matches_;
  VerificationParameters parameters_;
  bool specks_ = false;  ///< holes of one pixel in the table, which are blobs too small to count
};

TEST_F(RestingProposals, AreTheSameBesideSpecks) {
  const auto found = find();
  specks_ = true;
  const auto beside_specks = find();
  ASSERT_EQ(beside_specks.size(), found.size());
  for (size_t i = 0; i < found.size(); ++i)
    EXPECT_LT(translationDistance(beside_specks[i].camera_from_object, found[i].camera_from_object), 0.003);
}

TEST_F(RestingProposals, FindWhatNoMatchShows) {
  const auto found = find();
  ASSERT_EQ(found.size(), 2u);
  for (const VerifiedHypothesis& one : found) {
    EXPECT_EQ(one.hypothesis.source, HypothesisSource::kShape);
    EXPECT_TRUE(one.hypothesis.consensus.empty());
    const Pose& truth = placed_[static_cast<size_t>(one.hypothesis.object)].camera_from_object;
    EXPECT_LT(translationDistance(one.camera_from_object, truth), 0.005);
    EXPECT_LT(rotationDistance(one.camera_from_object, truth), 0.05);
  }
}

TEST_F(RestingProposals, FindAHalfHiddenBox) {
  synthetic::Placed before = standing(synthetic::box(9), -0.16, 0.0);
  before.camera_from_object.translation() += Eigen::Vector3d(0.0, 0.0, -0.12);
  placed_[1] = before;  // hides the left of the box; nobody has trained it
  models_[1].cloud = synthetic::makeModel(synthetic::can(12), "can").cloud;
  const auto found = find();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].hypothesis.object, 0);
  EXPECT_LT(translationDistance(found[0].camera_from_object, placed_[0].camera_from_object), 0.01);
}

TEST_F(RestingProposals, ObjectsOfTheShapeWithAnotherTextureAreNotFound) {
  models_[0].cloud = synthetic::makeModel(synthetic::box(11), "box").cloud;
  models_[1].cloud = synthetic::makeModel(synthetic::can(12), "can").cloud;
  EXPECT_TRUE(find().empty());
}

TEST_F(RestingProposals, NeedAPlaneAndAnObjectThatIsLookedFor) {
  EXPECT_TRUE(find(false).empty());
  matches_.by_object[1].clear();
  const auto found = find();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].hypothesis.object, 0);
}

TEST_F(RestingProposals, CanBeSwitchedOff) {
  parameters_.resting_proposals = 0;
  EXPECT_TRUE(find().empty());
  parameters_ = {};
  parameters_.decision = Decision::kPaper;
  EXPECT_TRUE(find().empty());
}

TEST_F(RestingProposals, SameForAnyNumberOfThreads) {
  expectSameForAnyThreads([&] { return find(); });
}

bool restsOn(const PreparedModel& model, const Eigen::Vector3f& down, float reach) {
  for (const RestingPose& pose : model.resting_poses)
    if (pose.down.dot(down) > 0.998f && std::abs(pose.reach - reach) < 0.002f) return true;
  return false;
}

TEST(RestingPoses, ABoxRestsOnItsSides) {
  const PreparedModel model = prepareModel(synthetic::makeModel(synthetic::box(1), "box"));
  EXPECT_EQ(model.resting_poses.size(), 6u);
  for (const float side : {-1.0f, 1.0f}) {
    EXPECT_TRUE(restsOn(model, side * Eigen::Vector3f::UnitX(), 0.05f));
    EXPECT_TRUE(restsOn(model, side * Eigen::Vector3f::UnitY(), 0.08f));
    EXPECT_TRUE(restsOn(model, side * Eigen::Vector3f::UnitZ(), 0.03f));
  }
  EXPECT_NEAR(model.resting_poses.front().reach, 0.03f, 0.002f);
}

TEST(RestingPoses, ACanRestsOnItsEndsAndManyWaysOnItsSide) {
  const PreparedModel model = prepareModel(synthetic::makeModel(synthetic::can(1), "can"));
  EXPECT_TRUE(restsOn(model, Eigen::Vector3f::UnitY(), 0.055f));
  EXPECT_TRUE(restsOn(model, -Eigen::Vector3f::UnitY(), 0.055f));
  int lying = 0;
  for (const RestingPose& pose : model.resting_poses) lying += std::abs(pose.down.y()) < 0.1f;
  EXPECT_GE(lying, 6);
}

TEST(FaceTable, KnowsTheFacesOfABox) {
  const PreparedModel model = prepareModel(synthetic::makeModel(synthetic::box(1), "box"));
  const FaceTable::Face& face = model.faces.facing(Eigen::Vector3f(0.99f, 0.1f, -0.1f).normalized());
  EXPECT_LT((face.centroid - Eigen::Vector3f(0.05f, 0.0f, 0.0f)).norm(), 0.01f);
  EXPECT_NEAR(face.share, 0.08 * 0.03 / (2.0 * (0.05 * 0.08 + 0.08 * 0.03 + 0.03 * 0.05)), 0.04);
  const FaceTable::Face& half = model.halves.facing(Eigen::Vector3f(1.0f, 1.0f, 1.0f).normalized());
  EXPECT_NEAR(half.share, 0.5, 0.06);
}

}  // namespace
}  // namespace recognition
