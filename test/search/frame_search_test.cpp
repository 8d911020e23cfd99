#include "search/frame_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"
#include "alignment/any_threads.h"
#include "alignment/synthetic_scene.h"

namespace recognition {
namespace {

using synthetic::disturbed;
using synthetic::poseAt;

/// A box and a can, and a second box that hides part of the first.
class Verify : public ::testing::Test {
 protected:
  Verify()
      : placed_{{synthetic::box(1), poseAt({0.0, 0.0, 0.8})}, {synthetic::can(2), poseAt({0.2, 0.05, 0.9})}},
        models_{synthetic::makeModel(placed_[0].solid, "box"), synthetic::makeModel(placed_[1].solid, "can")},
        database_(synthetic::databaseOf(models_)) {}

  std::unique_ptr<synthetic::Scene> scene(const synthetic::Sensor& sensor = {}) const {
    return synthetic::render(placed_, models_, sensor);
  }

  RoundOutcome verify(const synthetic::Scene& scene, const std::vector<Hypothesis>& hypotheses, int round = 0) const {
    return FrameSearch(parameters_, database_, scene.view).run(hypotheses, round);
  }

  std::vector<synthetic::Placed> placed_;
  std::vector<ObjectModel> models_;
  ModelDatabase database_;
  VerificationParameters parameters_;
};

TEST_F(Verify, AcceptsWhatIsThere) {
  const auto s = scene();
  for (const Decision decision : {Decision::kConfidence, Decision::kPaper}) {
    parameters_.decision = decision;
    FrameSearch search(parameters_, database_, s->view);
    const RoundOutcome outcome = search.run(s->truth, 0);
    ASSERT_EQ(outcome.hypotheses.size(), 2u);
    for (const VerifiedHypothesis& h : outcome.hypotheses) {
      EXPECT_TRUE(h.accepted()) << rejectionName(h.rejection);
      EXPECT_GT(h.scores.s_d, 0.9);
      EXPECT_GT(h.scores.s_c, 0.9);
      EXPECT_GT(h.scores.s_o, 0.8);
      EXPECT_EQ(h.scores.best_segment, h.hypothesis.object + 1);
      EXPECT_GT(h.evidence.structure, 0.6);
      EXPECT_GT(h.evidence.inliers, 20);
    }
    EXPECT_EQ(search.detections().size(), 2u);
    const bool rounds = decision == Decision::kPaper;  // only the paper's rule asks for further rounds
    EXPECT_EQ(outcome.candidates, rounds ? (std::vector<int>{0, 1}) : std::vector<int>());
    EXPECT_EQ(outcome.finished, !rounds);
    EXPECT_EQ(outcome.explained.at<std::uint8_t>(240, 320), 255);
    EXPECT_EQ(outcome.explained.at<std::uint8_t>(20, 20), 0);
  }
}

TEST_F(Verify, LightDoesNotDecide) {
  const auto plain = scene();
  synthetic::Sensor sensor;
  sensor.gain = 0.6;
  sensor.offset = 70.0;
  const auto bright = scene(sensor);
  for (size_t i = 0; i < 2; ++i) {
    const VerifiedHypothesis a = verify(*plain, {plain->truth[i]}).hypotheses[0];
    const VerifiedHypothesis b = verify(*bright, {bright->truth[i]}).hypotheses[0];
    EXPECT_TRUE(b.accepted());
    EXPECT_NEAR(a.evidence.structure, b.evidence.structure, 0.15);
    EXPECT_GT(b.scores.s_c, a.scores.s_c - 0.1);
  }
  parameters_.illumination_compensation = false;
  EXPECT_LT(verify(*bright, {bright->truth[0]}).hypotheses[0].scores.s_c, 0.6);
}

TEST_F(Verify, RejectsAWrongPlace) {
  const auto s = scene();
  parameters_.refine = false;
  Hypothesis moved = s->truth[0];
  moved.camera_from_object = disturbed(moved.camera_from_object, 0.06, 0.0, 3);
  EXPECT_FALSE(verify(*s, {moved}).hypotheses[0].accepted());
  Hypothesis in_the_air = s->truth[0];
  in_the_air.camera_from_object.translation() += Eigen::Vector3d(-0.25, 0, 0);
  const RoundOutcome outcome = verify(*s, {in_the_air});
  EXPECT_EQ(outcome.hypotheses[0].rejection, Rejection::kProbe);
  EXPECT_EQ(outcome.hypotheses[0].level, TestLevel::kProbed);
  EXPECT_GT(outcome.hypotheses[0].scores.free_space, 0.9);
  EXPECT_TRUE(outcome.finished);
  EXPECT_TRUE(outcome.candidates.empty());
  EXPECT_EQ(cv::countNonZero(outcome.explained), 0);
}

TEST_F(Verify, RejectsAnObjectOfTheSameShapeWithAnotherTexture) {
  models_.push_back(synthetic::makeModel(synthetic::box(99), "other_box"));
  database_ = synthetic::databaseOf(models_);
  const auto s = scene();
  Hypothesis other = s->truth[0];
  other.object = 2;
  other.consensus.resize(8);
  const VerifiedHypothesis h = verify(*s, {other}).hypotheses[0];
  EXPECT_FALSE(h.accepted());
  EXPECT_LT(h.evidence.structure, 0.3);
  EXPECT_LT(h.confidence, 0.2);
}

TEST_F(Verify, OccludedIsNotWrong) {
  placed_.push_back({synthetic::box(5), poseAt({-0.035, 0.02, 0.6})});
  models_.push_back(synthetic::makeModel(placed_[2].solid, "front_box"));
  database_ = synthetic::databaseOf(models_);
  const auto s = scene();
  const VerifiedHypothesis hidden = verify(*s, {s->truth[0]}).hypotheses[0];
  EXPECT_LT(hidden.scores.visible, 0.7);
  EXPECT_LT(hidden.scores.free_space, 0.05);
  EXPECT_TRUE(hidden.accepted()) << rejectionName(hidden.rejection);
  parameters_.min_visible = 0.9;
  EXPECT_EQ(verify(*s, {s->truth[0]}).hypotheses[0].rejection, Rejection::kTooLittleSeen);
}

TEST_F(Verify, OneInstanceOnce) {
  const auto s = scene();
  Hypothesis again = s->truth[0];
  again.camera_from_object = disturbed(again.camera_from_object, 0.004, 1.0, 3);
  const RoundOutcome outcome = verify(*s, {s->truth[0], again});
  EXPECT_NE(outcome.hypotheses[0].accepted(), outcome.hypotheses[1].accepted());
  const VerifiedHypothesis& loser = outcome.hypotheses[outcome.hypotheses[0].accepted() ? 1 : 0];
  EXPECT_EQ(loser.rejection, Rejection::kDuplicate);
  EXPECT_EQ(loser.conflict_with, "box");
}

TEST_F(Verify, NearIdenticalObjectsAreDecidedWhereTheyDiffer) {
  // The twin's front has another texture on a fifth of its height only.
  synthetic::Solid twin = synthetic::box(1);
  const auto base = twin.texture, other = synthetic::patchwork(77);
  twin.texture = [=](const Eigen::Vector3d& p) {
    return p.z() < -0.02 && std::abs(p.y() - 0.02) < 0.016 ? other(p) : base(p);
  };
  models_.push_back(synthetic::makeModel(twin, "twin"));
  database_ = synthetic::databaseOf(models_);
  for (const bool twin_is_there : {false, true}) {
    if (twin_is_there) placed_[0].solid = twin;
    const auto s = scene();
    Hypothesis as_twin = s->truth[0];
    as_twin.object = 2;
    // Whichever was hypothesised, or both: the one that is there is detected.
    for (const std::vector<Hypothesis>& hypotheses :
         {std::vector<Hypothesis>{s->truth[0], as_twin}, std::vector<Hypothesis>{s->truth[0]},
          std::vector<Hypothesis>{as_twin}}) {
      FrameSearch search(parameters_, database_, s->view);
      search.run(hypotheses, 0);
      const std::vector<VerifiedHypothesis> detections = search.detections();
      ASSERT_EQ(detections.size(), 1u);
      EXPECT_EQ(detections[0].hypothesis.object, twin_is_there ? 2 : 0);
    }
  }
}

/// Scene features that agree with a wrong pose, as a label that repeats makes them.
std::vector<Correspondence> addAgreeing(const ObjectModel& model, const Pose& pose, int count,
                                        synthetic::Scene* scene) {
  const ModelFeatures& features = model.features.at(DescriptorType::kSurf128);
  std::vector<Correspondence> consensus;
  for (int f = 0; f < features.count() && static_cast<int>(consensus.size()) < count; ++f) {
    const Eigen::Vector3d p = pose * features.positions[static_cast<size_t>(f)].cast<double>();
    const Eigen::Vector3d normal = pose.linear() * features.view_directions[static_cast<size_t>(f)].cast<double>();
    if (normal.dot(p) > -0.5 * p.norm()) continue;
    const Eigen::Vector2d pixel = scene->view.camera.project(p);
    Keypoint keypoint;
    keypoint.x = static_cast<float>(pixel.x());
    keypoint.y = static_cast<float>(pixel.y());
    consensus.push_back({static_cast<int>(scene->features.points.size()), f, 0.1f});
    scene->features.image.keypoints.push_back(keypoint);
    scene->features.image.descriptors.push_back(cv::Mat(1, 128, CV_32FC1, cv::Scalar(0.0)));
    scene->features.points.push_back(p.cast<float>());
  }
  return consensus;
}

TEST_F(Verify, TurnsACanThatWasFoundTheWrongWayRound) {
  const Pose& truth = placed_[1].camera_from_object;
  for (const double degrees : {60.0, 164.0}) {
    const auto s = scene();
    Hypothesis turned = s->truth[1];
    turned.camera_from_object = truth * Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitY());
    turned.consensus = addAgreeing(models_[1], turned.camera_from_object, 28, s.get());
    ASSERT_EQ(turned.consensus.size(), 28u);
    FrameSearch search(parameters_, database_, s->view);
    search.run({turned}, 0);
    ASSERT_EQ(search.detections().size(), 1u);
    const Pose found = search.detections()[0].camera_from_object;
    EXPECT_LT(rotationDistance(found, truth) * 180.0 / M_PI, 2.0);
    EXPECT_LT(translationDistance(found, truth), 0.004);
  }
}

TEST_F(Verify, SameForAnyNumberOfThreads) {
  const auto s = scene();
  std::vector<Hypothesis> hypotheses;
  for (std::uint32_t i = 0; i < 12; ++i) {
    hypotheses.push_back(s->truth[i % 2]);
    hypotheses.back().camera_from_object = disturbed(hypotheses.back().camera_from_object, 0.002 * i, i, i);
  }
  expectSameForAnyThreads([&] { return verify(*s, hypotheses).hypotheses; });
}

TEST_F(Verify, NothingToVerify) {
  const auto s = scene();
  const RoundOutcome outcome = verify(*s, {});
  EXPECT_TRUE(outcome.finished);
  EXPECT_TRUE(outcome.hypotheses.empty());
  EXPECT_EQ(outcome.explained.size(), s->depth.size());
}

TEST_F(Verify, BehindTheCameraAndOutOfView) {
  const auto s = scene();
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(0, 0, -0.8), Eigen::Vector3d(4, 0, 1)}) {
    Hypothesis away = s->truth[0];
    away.camera_from_object.translation() = place;
    EXPECT_EQ(verify(*s, {away}).hypotheses[0].rejection, Rejection::kOutOfView);
  }
}

TEST_F(Verify, ExhaustiveAndCascadeAgree) {
  const auto s = scene();
  std::vector<Hypothesis> hypotheses = s->truth;
  for (std::uint32_t i = 0; i < 10; ++i) {
    hypotheses.push_back(s->truth[i % 2]);
    hypotheses.back().camera_from_object = disturbed(hypotheses.back().camera_from_object, 0.01 * i, 5.0 * i, i);
  }
  std::vector<VerifiedHypothesis> found[2];
  for (const bool exhaustive : {false, true}) {
    parameters_.exhaustive = exhaustive;
    FrameSearch search(parameters_, database_, s->view);
    search.run(hypotheses, 0);
    found[exhaustive] = search.detections();
  }
  ASSERT_EQ(found[0].size(), found[1].size());
  for (size_t i = 0; i < found[0].size(); ++i) {
    EXPECT_EQ(found[0][i].hypothesis.object, found[1][i].hypothesis.object);
    EXPECT_LT(translationDistance(found[0][i].camera_from_object, found[1][i].camera_from_object), 0.002);
  }
}

TEST_F(Verify, WhatABetterOneExplainsIsNotTested) {
  const auto s = scene();
  Hypothesis weak = s->truth[0];
  weak.consensus.resize(8);
  const RoundOutcome outcome = verify(*s, {s->truth[0], s->truth[1], s->truth[1], s->truth[1], weak});
  EXPECT_EQ(outcome.hypotheses.back().rejection, Rejection::kExplained);
  EXPECT_EQ(outcome.hypotheses.back().conflict_with, "box");
  EXPECT_EQ(outcome.hypotheses.back().level, TestLevel::kProbed);
}

TEST_F(Verify, ABudgetIsKeptAndSaid) {
  const auto s = scene();
  std::vector<Hypothesis> hypotheses(12, s->truth[1]);
  hypotheses.push_back(s->truth[0]);
  FrameSearch search(parameters_, {}, std::make_shared<const PreparedModels>(database_), s->view, 1.0);
  const RoundOutcome outcome = search.run(hypotheses, 0);
  EXPECT_EQ(outcome.hypotheses.size(), hypotheses.size());
  EXPECT_EQ(outcome.hypotheses.back().rejection, Rejection::kBudget);
  ASSERT_EQ(search.report().left_out.size(), 1u);
  EXPECT_THAT(search.report().left_out[0], testing::HasSubstr("hypotheses"));
  EXPECT_FALSE(search.detections().empty()) << "the best ones were tested";
}

TEST_F(Verify, RejectsAPoseThatIsNoRigidMotionAndANegativeBudget) {
  const auto s = scene();
  Hypothesis bad = s->truth[0];
  bad.camera_from_object.linear() *= 1.1;
  EXPECT_THAT(refusal([&] { verify(*s, {bad}); }), testing::HasSubstr("box has a pose that is no rigid motion"));
  bad = s->truth[0];
  bad.camera_from_object.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(verify(*s, {bad}), std::invalid_argument);
  EXPECT_THROW(FrameSearch(parameters_, {}, std::make_shared<const PreparedModels>(database_), s->view, -1.0),
               std::invalid_argument);
}

TEST_F(Verify, RejectsIndicesThatDoNotExist) {
  const auto s = scene();
  Hypothesis bad = s->truth[0];
  bad.object = 2;
  EXPECT_THROW(verify(*s, {bad}), std::invalid_argument);
  bad = s->truth[0];
  bad.consensus[0].model_feature = 100000;
  EXPECT_THROW(verify(*s, {bad}), std::invalid_argument);
  bad = s->truth[0];
  bad.consensus[0].scene_feature = -1;
  EXPECT_THROW(verify(*s, {bad}), std::invalid_argument);
}

TEST_F(Verify, RoundsEnd) {
  const auto s = scene();
  parameters_.decision = Decision::kPaper;
  parameters_.max_rounds = 2;
  FrameSearch search(parameters_, database_, s->view);
  EXPECT_FALSE(search.run({s->truth[0]}, 0).finished);
  const RoundOutcome second = search.run({s->truth[1]}, 1);
  EXPECT_TRUE(second.finished);
  EXPECT_EQ(second.hypotheses.size(), 1u);
  EXPECT_EQ(search.detections().size(), 2u);
}

TEST_F(Verify, PaperHalvesTheThresholdAfterTheFirstRound) {
  const auto s = scene();
  parameters_.decision = Decision::kPaper;
  parameters_.refine = false;
  const double total = verify(*s, {s->truth[0]}).hypotheses[0].scores.total;
  parameters_.theta_c = std::min(1.0, 1.2 * total);
  EXPECT_EQ(verify(*s, {s->truth[0]}, 0).hypotheses[0].rejection, Rejection::kConsistency);
  EXPECT_TRUE(verify(*s, {s->truth[0]}, 1).hypotheses[0].accepted());
}

TEST_F(Verify, PaperKeepsOneHypothesisASegment) {
  models_.push_back(models_[0]);
  models_.back().name = "same_box";
  database_ = synthetic::databaseOf(models_);
  parameters_.decision = Decision::kPaper;
  parameters_.refine = false;
  const auto s = scene();
  Hypothesis shifted = s->truth[0];
  shifted.object = 2;
  shifted.camera_from_object.translation() += Eigen::Vector3d(0.004, 0, 0);
  const RoundOutcome outcome = verify(*s, {shifted, s->truth[0]});
  for (const VerifiedHypothesis& h : outcome.hypotheses)
    EXPECT_EQ(h.rejection, h.hypothesis.object == 2 ? Rejection::kConflict : Rejection::kNone);
}

TEST(VerificationParameters, ValidateNamesTheField) {
  VerificationParameters parameters;
  EXPECT_NO_THROW(parameters.validate());
  parameters.theta_c = 1.5;
  EXPECT_THAT(refusal([&] { parameters.validate(); }), testing::HasSubstr("reprojection_verification/theta_c"));
}

}  // namespace
}  // namespace recognition
