#include "tracking/pose_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace recognition {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr double kFrame = 1.0 / 30.0;

Pose poseAt(const Eigen::Vector3d& place, double degrees = 0.0) {
  Pose pose = Pose::Identity();
  pose.translation() = place;
  pose.linear() = Eigen::AngleAxisd(degrees * kDegree, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return pose;
}

Matrix6d noise(double translation, double degrees) {
  Matrix6d covariance = Matrix6d::Identity();
  covariance.diagonal().head<3>().setConstant(translation * translation);
  covariance.diagonal().tail<3>().setConstant(std::pow(degrees * kDegree, 2));
  return covariance;
}

/// Measurements of a noisy sensor, 30 a second.
class Measured {
 public:
  explicit Measured(const Pose& start) : filter({0.0, 0.1, 0.0}, start, 0.0) {}

  void see(const Pose& truth) {
    stamp += kFrame;
    Vector6d error;
    for (int i = 0; i < 6; ++i) error[i] = (i < 3 ? 0.001 : 0.4 * kDegree) * normal_(random_);
    filter.measure(stamp, movedBy(error, truth), noise(0.001, 0.4));
  }

  PoseFilter filter;
  double stamp = 0.0;

 private:
  std::mt19937 random_{5};
  std::normal_distribution<double> normal_;
};

TEST(PoseFilter, AveragesWhatStands) {
  Measured run(poseAt({0, 0, 1}, 30));
  for (int i = 0; i < 30; ++i) run.see(poseAt({0, 0, 1}, 30));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  double turn = 0.0;
  constexpr int kFrames = 300;
  for (int i = 0; i < kFrames; ++i) {
    run.see(poseAt({0, 0, 1}, 30));
    EXPECT_FALSE(run.filter.moves());
    const Eigen::Vector3d off = run.filter.pose().translation() - Eigen::Vector3d(0, 0, 1);
    sum += off;
    squares += off.cwiseAbs2();
    turn = std::max(turn, rotationDistance(run.filter.pose(), poseAt({0, 0, 1}, 30)));
  }
  EXPECT_LT((squares / kFrames - (sum / kFrames).cwiseAbs2()).cwiseSqrt().maxCoeff(), 0.0005);
  EXPECT_LT(turn, 0.6 * kDegree);
}

TEST(PoseFilter, FollowsWhatMovesAndComesToRestWithIt) {
  Measured run(poseAt({0, 0, 1}));
  for (int i = 0; i < 30; ++i) run.see(poseAt({0, 0, 1}));
  Pose truth;
  for (int i = 0; i < 60; ++i) {
    truth = poseAt({0.3 * kFrame * i, 0, 1}, 60.0 * kFrame * i);
    run.see(truth);
    if (i < 10) continue;
    EXPECT_TRUE(run.filter.moves());
    EXPECT_LT(translationDistance(run.filter.pose(), truth), 0.01);
    EXPECT_LT(rotationDistance(run.filter.pose(), truth), 2.0 * kDegree);
  }
  EXPECT_NEAR(run.filter.velocity()[4], 60.0 * kDegree, 15.0 * kDegree);
  EXPECT_LT(translationDistance(run.filter.predicted(run.stamp + 0.1),
                                poseAt({0.3 * (kFrame * 59 + 0.1), 0, 1}, 60.0 * (kFrame * 59 + 0.1))),
            0.02);
  for (int i = 0; i < 30; ++i) run.see(truth);
  EXPECT_FALSE(run.filter.moves());
  EXPECT_LT(translationDistance(run.filter.pose(), truth), 0.002);
  EXPECT_TRUE(run.filter.velocity().isZero());
}

TEST(PoseFilter, HoldsWhatIsNotMeasured) {
  Measured run(poseAt({0, 0, 1}));
  for (int i = 0; i < 60; ++i) run.see(poseAt({0.3 * kFrame * i, 0, 1}));
  const Pose last = run.filter.pose();
  for (int i = 0; i < 90; ++i) run.filter.hold(run.stamp += kFrame);
  EXPECT_LT(translationDistance(run.filter.pose(), last), 0.04);
  EXPECT_LT(run.filter.velocity().norm(), 1e-3);
}

TEST(PoseFilter, FollowsASlowDrift) {
  Measured run(poseAt({0, 0, 1}));
  for (int i = 0; i < 300; ++i) {
    const Pose truth = poseAt({0.005 * kFrame * i, 0, 1});
    run.see(truth);
    EXPECT_LT(translationDistance(run.filter.pose(), truth), 0.006);
  }
}

}  // namespace
}  // namespace recognition
