#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "search/frame_search.h"
#include "alignment/surface_probe.h"
#include "alignment/any_threads.h"
#include "alignment/synthetic_scene.h"
#include "rgbd_recognition/matching/scene_matches.h"
#include "alignment/prepared_model.h"

namespace recognition {
namespace {

using synthetic::disturbed;
using synthetic::poseAt;

double degreesBetween(const Pose& a, const Pose& b) { return rotationDistance(a, b) * 180.0 / M_PI; }

/// A box and a can whose features know their orientations, trained from 15 degrees beside the camera.
class Proposals : public ::testing::Test {
 protected:
  Proposals()
      : placed_{{synthetic::box(1), poseAt({0.0, 0.0, 0.8})}, {synthetic::can(2), poseAt({0.2, 0.05, 0.9})}},
        models_{synthetic::makeModel(placed_[0].solid, "box"), synthetic::makeModel(placed_[1].solid, "can")} {
    for (size_t i = 0; i < placed_.size(); ++i) orient(placed_[i].camera_from_object, &models_[i]);
    database_ = synthetic::databaseOf(models_);
    scene_ = synthetic::render(placed_, models_, {});
    for (size_t i = 0; i < placed_.size(); ++i)
      for (const Correspondence& pair : scene_->truth[i].consensus) turnKeypoint(static_cast<int>(i), pair);
    matches_.by_object.resize(placed_.size());
  }

  static void orient(const Pose& camera_from_object, ObjectModel* model) {
    ModelFeatures& features = model->features.at(DescriptorType::kSurf128);
    const Eigen::AngleAxisf beside(static_cast<float>(M_PI / 12.0), Eigen::Vector3f::UnitY());
    for (size_t i = 0; i < features.positions.size(); ++i) {
      const Eigen::Vector3f p = camera_from_object.cast<float>() * features.positions[i];
      const Eigen::Vector3f towards = camera_from_object.linear().transpose().cast<float>() * (-p.normalized());
      features.view_directions[i] = beside * towards;
      features.orientations.push_back(features.view_directions[i].unitOrthogonal());
    }
  }

  void turnKeypoint(int object, const Correspondence& pair) {
    const ModelFeatures& features = models_[static_cast<size_t>(object)].features.at(DescriptorType::kSurf128);
    const Eigen::Vector3f direction = placed_[static_cast<size_t>(object)].camera_from_object.linear().cast<float>() *
                                      features.orientations[static_cast<size_t>(pair.model_feature)];
    scene_->features.image.keypoints[static_cast<size_t>(pair.scene_feature)].angle =
        std::atan2(direction.y(), direction.x());
  }

  /// A few right matches of each object among wrong ones: too few for a consensus set.
  void match(int right, int wrong) {
    std::mt19937 random(3);
    const int count = static_cast<int>(scene_->features.points.size());
    for (size_t i = 0; i < placed_.size(); ++i) {
      const auto& truth = scene_->truth[i].consensus;
      for (int k = 0; k < right; ++k) matches_.by_object[i].push_back(truth[static_cast<size_t>(k * 7) % truth.size()]);
      const int own = models_[i].features.at(DescriptorType::kSurf128).count();
      for (int k = 0; k < wrong; ++k)
        matches_.by_object[i].push_back({static_cast<int>(random() % static_cast<unsigned>(count)),
                                         static_cast<int>(random() % static_cast<unsigned>(own)), 0.5f});
    }
  }

  std::vector<VerifiedHypothesis> find() const {
    FrameSearch search(parameters_, database_, scene_->view);
    search.run({}, 0, &matches_);
    return search.detections();
  }

  std::vector<synthetic::Placed> placed_;
  std::vector<ObjectModel> models_;
  ModelDatabase database_;
  std::unique_ptr<synthetic::Scene> scene_;
  SceneMatches matches_;
  VerificationParameters parameters_;
};

TEST_F(Proposals, FindWhatTooFewMatchesShow) {
  match(2, 100);
  const auto found = find();
  ASSERT_EQ(found.size(), 2u);
  for (const VerifiedHypothesis& one : found) {
    EXPECT_TRUE(lacksConsensus(one.hypothesis.source));
    const Pose& truth = placed_[static_cast<size_t>(one.hypothesis.object)].camera_from_object;
    EXPECT_LT((one.camera_from_object.translation() - truth.translation()).norm(), 0.005);
    EXPECT_LT(degreesBetween(one.camera_from_object, truth), 3.0);
  }
}

TEST_F(Proposals, ObjectsOfTheShapeWithAnotherTextureAreNotFound) {
  match(2, 200);
  for (size_t i = 0; i < models_.size(); ++i) {
    const auto other = i == 0 ? synthetic::box(11) : synthetic::can(12);
    models_[i].cloud = synthetic::makeModel(other, models_[i].name).cloud;
  }
  database_ = synthetic::databaseOf(models_);
  EXPECT_TRUE(find().empty());
}

TEST_F(Proposals, CanBeSwitchedOff) {
  match(2, 100);
  parameters_.correspondence_proposals = 0;
  EXPECT_TRUE(find().empty());
  parameters_ = {};
  parameters_.decision = Decision::kPaper;
  EXPECT_TRUE(find().empty());
}

TEST_F(Proposals, SameForAnyNumberOfThreads) {
  match(2, 100);
  expectSameForAnyThreads([&] { return find(); });
}

TEST_F(Proposals, RejectsMatchesThatDoNotFit) {
  match(1, 0);
  matches_.by_object[1].push_back({0, 100000, 0.1f});
  EXPECT_THROW(find(), std::invalid_argument);
  matches_.by_object.pop_back();
  EXPECT_THROW(find(), std::invalid_argument);
}

TEST_F(Proposals, ProbeTellsTheTruePoseFromOthers) {
  const PreparedModel model = prepareModel(models_[0]);
  const Pose& truth = placed_[0].camera_from_object;
  const ProbeResult there = probeSurface(model, 400, truth, scene_->view);
  EXPECT_GT(there.facing, 100);
  EXPECT_GT(there.agreeing, 0.9);
  EXPECT_LT(there.free_space, 0.05);
  EXPECT_GT(there.correlation, 0.7);
  Pose beside = truth;
  beside.translation().y() -= 0.2;
  EXPECT_GT(probeSurface(model, 400, beside, scene_->view).free_space, 0.5);
  Pose turned = truth;
  turned.linear() = truth.linear() * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_GT(probeSurface(model, 400, turned, scene_->view).agreeing, 0.9);
  EXPECT_LT(probeSurface(model, 400, turned, scene_->view).correlation, 0.4);
}

TEST_F(Proposals, SettlesOnTheDepth) {
  const PreparedModel model = prepareModel(models_[0]);
  const Pose& truth = placed_[0].camera_from_object;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const Pose settled = alignToDepth(model, 120, disturbed(truth, 0.015, 12.0, seed), scene_->view);
    EXPECT_LT((settled.translation() - truth.translation()).norm(), 0.012) << seed;
    EXPECT_LT(degreesBetween(settled, truth), 6.0) << seed;
  }
  Pose beside = truth;
  beside.translation().z() -= 0.5;
  EXPECT_EQ(alignToDepth(model, 120, beside, scene_->view).matrix(), beside.matrix());
}

}  // namespace
}  // namespace recognition
