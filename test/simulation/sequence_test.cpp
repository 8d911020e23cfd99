#include "simulation/sequence.h"

#include <gtest/gtest.h>

#include "simulation/fixtures.h"
#include "simulation/ray_scene.h"
#include "simulation/visibility.h"

namespace recognition {
namespace {

constexpr double kDegrees = 180.0 / CV_PI;

/// Two boxes on nothing, seen from above.
TabletopScene twoBoxes() {
  TabletopScene scene;
  for (int i = 0; i < 2; ++i) {
    const CatalogObject box = boxObject(i + 1, {0.06, 0.08, 0.1}, 3);
    SceneBody body;
    body.appearance = box.appearance;
    body.world_from_body = Pose::Identity();
    body.world_from_body.translation() = Eigen::Vector3d(0.2 * i, 0.0, 0.05);
    body.object_id = box.id;
    scene.scene.bodies.push_back(body);
    scene.objects.push_back(i);
  }
  scene.scene.world_from_camera = lookAt({0.1, -0.6, 0.6}, {0.1, 0.0, 0.0});
  return scene;
}

SequenceParameters still() {
  SequenceParameters parameters;
  parameters.path = CameraPath::kStill;
  parameters.moved = parameters.passing = 0;
  return parameters;
}

Pose placeOf(const SceneInMotion& motion, int body, double seconds) {
  return motion.at(seconds).bodies[static_cast<size_t>(body)].world_from_body;
}

TEST(SceneInMotion, NothingMovesWhereNothingIsToMove) {
  const SceneInMotion motion(twoBoxes(), still(), 1);
  for (const double seconds : {0.0, 1.0, 5.0}) {
    EXPECT_TRUE(motion.at(seconds).world_from_camera.isApprox(motion.at(0.0).world_from_camera));
    EXPECT_TRUE(placeOf(motion, 0, seconds).isApprox(placeOf(motion, 0, 0.0)));
  }
}

TEST(SceneInMotion, CarriedThingsKeepTheirSpeedAndAreSetDownAtTheirHeight) {
  SequenceParameters parameters = still();
  parameters.moved = 1;
  const SceneInMotion motion(twoBoxes(), parameters, 1);
  double speed = 0.0, turn = 0.0, height = 0.0;
  for (double t = 0.0; t < 10.0; t += 0.01) {
    const Pose a = placeOf(motion, 0, t), b = placeOf(motion, 0, t + 0.01);
    speed = std::max(speed, translationDistance(a, b) / 0.01);
    turn = std::max(turn, kDegrees * rotationDistance(a, b) / 0.01);
    height = std::max(height, a.translation().z());
  }
  EXPECT_LT(speed, 1.1 * parameters.max_speed);
  EXPECT_GT(speed, 0.5 * parameters.max_speed);
  EXPECT_LT(turn, 1.1 * parameters.max_turn);
  EXPECT_GT(turn, 20.0);
  EXPECT_GT(height, 0.15);
  EXPECT_NEAR(placeOf(motion, 0, 10.0).translation().z(), 0.05, 1e-9);
  EXPECT_GT(translationDistance(placeOf(motion, 0, 10.0), placeOf(motion, 0, 0.0)), 0.1);
  EXPECT_TRUE(placeOf(motion, 1, 3.0).isApprox(placeOf(motion, 1, 0.0)));
}

TEST(SceneInMotion, CamerasMoveSmoothlyAndTheSameWayAgain) {
  for (const CameraPath path : {CameraPath::kHandHeld, CameraPath::kArm, CameraPath::kPanTilt}) {
    SequenceParameters parameters = still();
    parameters.path = path;
    const SceneInMotion motion(twoBoxes(), parameters, 4), again(twoBoxes(), parameters, 4);
    double way = 0.0, turn = 0.0;
    for (double t = 0.0; t < 10.0; t += 1.0 / 30.0) {
      const Pose a = motion.at(t).world_from_camera, b = motion.at(t + 1.0 / 30.0).world_from_camera;
      EXPECT_LT(translationDistance(a, b), 0.02);
      EXPECT_LT(kDegrees * rotationDistance(a, b), 2.0);
      EXPECT_TRUE(a.isApprox(again.at(t).world_from_camera));
      way = std::max(way, translationDistance(a, motion.at(0.0).world_from_camera));
      turn = std::max(turn, kDegrees * rotationDistance(a, motion.at(0.0).world_from_camera));
    }
    EXPECT_GT(turn, 2.0);
    EXPECT_EQ(way > 0.01, path != CameraPath::kPanTilt);
  }
}

TEST(SceneInMotion, SomethingPassesBetweenCameraAndThings) {
  SequenceParameters parameters = still();
  parameters.passing = 1;
  const SceneInMotion motion(twoBoxes(), parameters, 1);
  const CameraModel camera{160, 120, 130.0, 130.0, 79.5, 59.5};
  const auto hidden = [&](double seconds) {
    const Scene scene = motion.at(seconds);
    const RayScene rays(scene);
    const cv::Mat bodies = renderBodies(rays, camera);
    return measureVisibility(rays, camera, bodies, 0).fraction();
  };
  EXPECT_GT(hidden(0.5), 0.9);
  double least = 1.0;
  for (double t = 1.0; t < 3.6; t += 0.1) least = std::min(least, hidden(t));
  EXPECT_LT(least, 0.5);
  EXPECT_GT(hidden(4.0), 0.9);
}

TEST(ImageMotion, IsThatOfWhatMoves) {
  SequenceParameters parameters = still();
  parameters.moved = 1;
  const SceneInMotion motion(twoBoxes(), parameters, 1);
  const CameraModel camera{160, 120, 130.0, 130.0, 79.5, 59.5};
  EXPECT_LT(cv::norm(imageMotion(motion, 0.2, camera), cv::NORM_INF), 1e-6);
  EXPECT_GT(cv::norm(imageMotion(motion, 1.6, camera), cv::NORM_INF), 5.0);
}

TEST(ExposedInMotion, BlursAlongTheMotionAndReadsRowsOneAfterTheOther) {
  cv::Mat edge(40, 40, CV_32FC3, cv::Scalar::all(0)), flow(40, 40, CV_32FC2, cv::Scalar(100.0, 0.0));
  edge.colRange(20, 40).setTo(cv::Scalar::all(1));
  const cv::Mat sharp = exposedInMotion(edge, cv::Mat(40, 40, CV_32FC2, cv::Scalar::all(0)), 0.05, 0.05);
  EXPECT_EQ(cv::norm(sharp, edge, cv::NORM_INF), 0.0);
  const cv::Mat blurred = exposedInMotion(edge, flow, 0.06, 0.0);
  EXPECT_NEAR(blurred.at<cv::Vec3f>(20, 20)[0], 0.5, 0.2);
  EXPECT_EQ(blurred.at<cv::Vec3f>(20, 10)[0], 0.0f);
  const cv::Mat rolled = exposedInMotion(edge, flow, 0.0, 0.1);  // by 5 pixels either way
  EXPECT_EQ(rolled.at<cv::Vec3f>(39, 22)[0], 0.0f);
  EXPECT_EQ(rolled.at<cv::Vec3f>(0, 17)[0], 1.0f);
}

TEST(SequenceParameters, OutOfRangeAreRefused) {
  SequenceParameters parameters;
  parameters.max_speed = 0.0;
  EXPECT_THROW(SceneInMotion(twoBoxes(), parameters, 1), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
