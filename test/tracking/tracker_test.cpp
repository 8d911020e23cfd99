#include "rgbd_recognition/tracking/tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace recognition {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr double kFrame = 1.0 / 15.0;

Pose poseAt(double x, double y, double z, double degrees = 0.0) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  pose.linear() = Eigen::AngleAxisd(degrees * kDegree, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return pose;
}

Eigen::Matrix<double, 6, 6> noise(double translation, double degrees) {
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();
  covariance.diagonal().head<3>().setConstant(translation * translation);
  covariance.diagonal().tail<3>().setConstant(std::pow(degrees * kDegree, 2));
  return covariance;
}

TrackedDetection detection(const Pose& pose, const std::string& object = "can", double confidence = 0.9) {
  return {object, pose, noise(0.004, 2.0), confidence};
}

/// Frames 15 times a second with the camera at the fixed frame's origin unless told otherwise.
struct Sequence {
  Tracker tracker{TrackingParameters{}};
  double stamp = 100.0;

  TrackingOutcome see(const std::vector<TrackedDetection>& detections, const Pose& camera = Pose::Identity()) {
    stamp += kFrame;
    return tracker.update(stamp, detections, camera);
  }
};

TEST(Tracker, FindsAfterTheSecondDetectionAndOnce) {
  Sequence run;
  EXPECT_TRUE(run.see({detection(poseAt(0, 0, 1))}).tracks.empty());
  const TrackingOutcome second = run.see({detection(poseAt(0, 0, 1))});
  ASSERT_EQ(1u, second.found.size());
  EXPECT_EQ("can", second.found[0].object);
  EXPECT_EQ(1u, second.tracks.size());
  EXPECT_TRUE(run.see({detection(poseAt(0, 0, 1))}).found.empty());
}

TEST(Tracker, AveragesNoisyPosesByTheirCovariance) {
  std::mt19937 random(5);
  std::normal_distribution<double> shift(0.0, 0.004), turn(0.0, 2.0);
  Sequence run;
  Track track;
  for (int i = 0; i < 60; ++i) {
    const Pose seen = poseAt(shift(random), shift(random), 1 + shift(random), 30 + turn(random));
    const TrackingOutcome outcome = run.see({detection(seen)});
    if (!outcome.tracks.empty()) track = outcome.tracks[0];
  }
  EXPECT_LT(translationDistance(track.fixed_from_object, poseAt(0, 0, 1)), 0.003);
  EXPECT_LT(rotationDistance(track.fixed_from_object, poseAt(0, 0, 1, 30)), 1.0 * kDegree);
  EXPECT_LT(track.covariance(0, 0), 0.5 * 0.004 * 0.004);
  EXPECT_GT(track.confidence, 0.99);
}

TEST(Tracker, InstanceNumbersStayWhateverTheOrderAndWhoIsMissed) {
  Sequence run;
  const TrackedDetection left = detection(poseAt(-0.2, 0, 1)), right = detection(poseAt(0.2, 0, 1));
  run.see({left, right});
  run.see({right, left});
  const TrackingOutcome one_missed = run.see({right});
  ASSERT_EQ(2u, one_missed.tracks.size());
  EXPECT_EQ(0, one_missed.tracks[0].instance);
  EXPECT_LT(one_missed.tracks[0].fixed_from_object.translation().x(), 0.0);
  EXPECT_EQ(1, one_missed.tracks[1].instance);
  EXPECT_GT(one_missed.tracks[1].fixed_from_object.translation().x(), 0.0);
}

TEST(Tracker, LosesWhatIsNoLongerSeenAndGivesItsNumberAway) {
  Sequence run;
  for (int i = 0; i < 3; ++i) run.see({detection(poseAt(0, 0, 1))});
  std::vector<Track> lost;
  int frames = 0;
  for (; frames < 60 && lost.empty(); ++frames) lost = run.see({}).lost;
  ASSERT_EQ(1u, lost.size());
  EXPECT_NEAR(run.tracker.parameters().lost_after, frames * kFrame, 2 * kFrame);
  run.see({detection(poseAt(0.3, 0, 1))});
  EXPECT_EQ(0, run.see({detection(poseAt(0.3, 0, 1))}).found.at(0).instance);
}

TEST(Tracker, MissesNothingThatIsOutOfView) {
  Sequence run;
  for (int i = 0; i < 3; ++i) run.see({detection(poseAt(0, 0, 1))});
  const Pose looking_away = poseAt(0, 0, 0, 90);
  for (int i = 0; i < 60; ++i) EXPECT_EQ(1u, run.see({}, looking_away).tracks.size());
}

TEST(Tracker, ViewsOfAMovingCameraAddUpInTheFixedFrame) {
  Sequence run;
  const Pose object = poseAt(0.1, 0.0, 1.0, 10);
  Track track;
  for (int i = 0; i < 10; ++i) {
    const Pose fixed_from_camera = poseAt(0.02 * i, 0, 0, -i);
    const Pose camera_from_object = fixed_from_camera.inverse() * object;
    const TrackingOutcome outcome = run.see({detection(fixed_from_camera * camera_from_object)}, fixed_from_camera);
    if (!outcome.tracks.empty()) track = outcome.tracks[0];
  }
  EXPECT_EQ(10, track.detections);
  EXPECT_LT(translationDistance(track.fixed_from_object, object), 1e-9);
}

TEST(Tracker, AnObjectThatWasTurnedGetsItsNewPoseWhenTwoDetectionsAgree) {
  Sequence run;
  for (int i = 0; i < 3; ++i) run.see({detection(poseAt(0, 0, 1))});
  const Pose turned = poseAt(0, 0, 1, 120);
  EXPECT_LT(rotationDistance(run.see({detection(turned)}).tracks.at(0).fixed_from_object, poseAt(0, 0, 1)), 1e-6);
  EXPECT_LT(rotationDistance(run.see({detection(turned)}).tracks.at(0).fixed_from_object, turned), 1e-6);
}

TEST(Tracker, ForgetsAllWhenTimeGoesBackwards) {
  Sequence run;
  for (int i = 0; i < 3; ++i) run.see({detection(poseAt(0, 0, 1))});
  run.stamp = 10.0;
  const TrackingOutcome outcome = run.see({detection(poseAt(0, 0, 1))});
  EXPECT_TRUE(outcome.restarted);
  EXPECT_TRUE(outcome.tracks.empty());
}

TEST(Tracker, RefusesParametersOutOfRange) {
  TrackingParameters parameters;
  parameters.confirm_frames = 0;
  EXPECT_THROW(Tracker{parameters}, std::invalid_argument);
}

}  // namespace
}  // namespace recognition
