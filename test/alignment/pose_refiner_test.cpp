#include "alignment/pose_refiner.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "alignment/synthetic_scene.h"
#include "alignment/prepared_model.h"

namespace recognition {
namespace {

using synthetic::disturbed;
using synthetic::poseAt;
using synthetic::Solid;

class RefineSolid : public ::testing::TestWithParam<Solid::Shape> {
 protected:
  RefineSolid() : solid_(GetParam() == Solid::Shape::kBox ? synthetic::box(1) : synthetic::can(2)) {
    object_ = synthetic::makeModel(solid_, "solid");
    model_ = prepareModel(object_);
    scene_ = synthetic::render({{solid_, truth_}}, {object_}, {});
  }

  Refinement refine(const Pose& start, int consensus, const RefinementOptions& options = {}) const {
    Hypothesis hypothesis = scene_->truth[0];
    hypothesis.consensus.resize(std::min<size_t>(hypothesis.consensus.size(), static_cast<size_t>(consensus)));
    return refinePose(model_, object_, hypothesis, start, scene_->view, options);
  }

  void expectTruth(const Refinement& refinement, double metres, double degrees) const {
    EXPECT_TRUE(refinement.success);
    EXPECT_LT(translationDistance(refinement.camera_from_object, truth_), metres);
    EXPECT_LT(rotationDistance(refinement.camera_from_object, truth_) * 180.0 / M_PI, degrees);
  }

  Solid solid_;
  Pose truth_ = poseAt({0.03, -0.02, 0.8});
  ObjectModel object_;
  PreparedModel model_;
  std::unique_ptr<synthetic::Scene> scene_;
};

TEST_P(RefineSolid, FromTwoCentimetresAndTenDegrees) {
  for (std::uint32_t seed = 0; seed < 10; ++seed)
    expectTruth(refine(disturbed(truth_, 0.02, 10.0, seed), 25), 0.002, 0.7);
}

TEST_P(RefineSolid, PrintAloneHoldsWhatGeometryLetsSlide) {
  for (std::uint32_t seed = 0; seed < 5; ++seed)
    expectTruth(refine(disturbed(truth_, 0.003, 2.0, seed), 0), 0.002, 0.7);
}

TEST_P(RefineSolid, FeaturesAloneHoldWhatGeometryLetsSlide) {
  RefinementOptions options;
  options.use_lightness = false;
  for (std::uint32_t seed = 0; seed < 5; ++seed)
    expectTruth(refine(disturbed(truth_, 0.02, 10.0, seed), 25, options), 0.003, 1.2);
}

TEST_P(RefineSolid, CovarianceIsThatOfTheErrors) {
  double normalised = 0.0;
  constexpr int kTrials = 24;
  for (int i = 0; i < kTrials; ++i) {
    synthetic::Sensor sensor;
    sensor.seed = static_cast<std::uint32_t>(100 + i);
    sensor.depth_scale = 1.0 + 0.012 * std::sin(1.7 * i);  // as the covariance allows for
    const Pose truth = poseAt({0.01 * i - 0.1, 0.02, 0.7 + 0.01 * i}, 7.0 * i);
    const auto scene = synthetic::render({{solid_, truth}}, {object_}, sensor);
    RefinementOptions options;
    const Refinement r = refinePose(model_, object_, scene->truth[0],
                                    disturbed(truth, 0.01, 5.0, static_cast<std::uint32_t>(i)), scene->view, options);
    Vector6d error;
    error.head<3>() = truth.translation() - r.camera_from_object.translation();
    const Eigen::AngleAxisd turn(truth.linear() * r.camera_from_object.linear().transpose());
    error.tail<3>() = turn.angle() * turn.axis();
    normalised += error.dot(r.covariance.ldlt().solve(error)) / kTrials;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(r.covariance).eigenvalues()[0], 0.0);
  }
  RecordProperty("normalised_error", std::to_string(normalised));
  EXPECT_GT(normalised, 0.08);  // 6 if exact; the sensor's smooth errors and those of meshes are not in this scene
  EXPECT_LT(normalised, 18.0);
}

INSTANTIATE_TEST_SUITE_P(Solids, RefineSolid, ::testing::Values(Solid::Shape::kBox, Solid::Shape::kCan));

/// Deviation of the rotation about an axis of the object, degrees.
double deviationAbout(const Eigen::Vector3d& axis, const Pose& pose, const Matrix6d& covariance) {
  const Eigen::Vector3d in_camera = pose.linear() * axis;
  return std::sqrt(in_camera.dot(covariance.bottomRightCorner<3, 3>() * in_camera)) * 180.0 / M_PI;
}

/// Refines a can at its true pose, without features.
Refinement refineCan(const Solid& can, const Pose& truth, std::uint32_t seed) {
  const ObjectModel object = synthetic::makeModel(can, "can");
  synthetic::Sensor sensor;
  sensor.seed = seed;
  const auto scene = synthetic::render({{can, truth}}, {object}, sensor);
  RefinementOptions options;
  return refinePose(prepareModel(object), object, Hypothesis{}, truth, scene->view, options);
}

TEST(Covariance, KnowsThatABlankCanMayBeTurned) {
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitY();
  const Pose truth = poseAt({0.02, 0.0, 0.8});
  Solid blank = synthetic::can(2);
  blank.texture = [](const Eigen::Vector3d&) { return cv::Vec3b(180, 170, 160); };
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const Refinement printed_one = refineCan(synthetic::can(2), truth, seed), blank_one = refineCan(blank, truth, seed);
    ASSERT_TRUE(printed_one.success && blank_one.success);
    EXPECT_LT(deviationAbout(axis, truth, printed_one.covariance), 5.0);
    EXPECT_GT(deviationAbout(axis, truth, blank_one.covariance), 40.0);
    EXPECT_LT(deviationAbout(truth.linear().transpose().col(2).cross(axis).normalized(), truth, blank_one.covariance),
              8.0)
        << "depth determines this";
  }
}

/// A sensor's scale of depth is not known better: farther away is less certain, along the ray alone.
TEST(Covariance, GrowsAlongTheRay) {
  const Solid can = synthetic::can(2);
  double before = 0.0;
  for (const double z : {0.6, 1.2}) {
    const Refinement refined = refineCan(can, poseAt({0.0, 0.0, z}), 1);
    const double along = std::sqrt(refined.covariance(2, 2)), across = std::sqrt(refined.covariance(1, 1));
    EXPECT_GT(along, 0.0075 * z);
    EXPECT_GT(along, across);
    EXPECT_GT(along, 1.5 * before);
    before = along;
  }
}

TEST(RefinePose, KeepsThePoseWhereNothingIsSeen) {
  const ObjectModel object = synthetic::makeModel(synthetic::box(1), "box");
  const auto scene = synthetic::render({}, {}, {});
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(0, 0, 0.8), Eigen::Vector3d(0, 0, -0.8), Eigen::Vector3d(5, 0, 1)}) {
    const Refinement refinement =
        refinePose(prepareModel(object), object, Hypothesis{}, poseAt(place), scene->view, {});
    EXPECT_FALSE(refinement.success);
    EXPECT_TRUE(refinement.camera_from_object.isApprox(poseAt(place)));
  }
}

}  // namespace
}  // namespace recognition
