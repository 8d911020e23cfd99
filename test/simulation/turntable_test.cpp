#include "simulation/turntable.h"

#include <gtest/gtest.h>

#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "simulation/fixtures.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

FiducialBoard shippedBoard(const std::string& name) {
  return FiducialBoard::fromYaml(std::string(RGBD_SOURCE_DIR) + "/config/boards/" + name);
}

class TurntableBoard : public testing::TestWithParam<std::string> {};

TEST_P(TurntableBoard, IsFoundAtItsPose) {
  const CatalogObject object = boxObject(4, {0.07, 0.05, 0.1}, 1);
  const FiducialBoard board = shippedBoard(GetParam());
  const SimulatedKinect kinect{KinectParameters()};
  int found = 0;
  for (const int view : {29, 40, 52, 66}) {
    const Scene scene = turntableView(object, board, TurntableParameters(), view, 1);
    const RgbdFrame frame = kinect.capture(RayScene(scene), 1);
    const auto observation = detectBoard(board, toGray(frame.color, frame.color_order), frame.color_camera);
    if (!observation) continue;
    ++found;
    const Pose expected = scene.world_from_camera.inverse() * scene.bodies[scene.bodies.size() - 2].world_from_body;
    EXPECT_LT(translationDistance(observation->camera_from_board, expected), 0.006) << "view " << view;
    EXPECT_LT(rotationDistance(observation->camera_from_board, expected), 0.015) << "view " << view;
  }
  EXPECT_GE(found, 3);
}

INSTANTIATE_TEST_SUITE_P(Shipped, TurntableBoard, testing::Values("charuco.yaml", "two_checkerboards.yaml"));

TEST(Turntable, IsRecordedWithPoses) {
  const TemporaryDirectory folder;
  TurntableParameters parameters;
  parameters.views = 4;
  parameters.tilts = 2;
  KinectParameters kinect;
  kinect.color_mode = ColorMode::kVga;
  kinect.samples = 1;
  const CatalogObject object = boxObject(4, {0.1, 0.08, 0.15}, 1);
  writeTurntable(object, shippedBoard("two_checkerboards.yaml"), kinect, parameters, 1, folder.string(),
                 [](int, int) {});
  const auto frames = readBopSplit(folder / "train_kinect");
  ASSERT_EQ(frames.size(), 4u);
  for (const auto& frame : frames) EXPECT_GT(frame.ground_truth.at(0).visibility, 0.95);
  const Pose turn =
      frames[0].ground_truth[0].camera_from_object.inverse() * frames[1].ground_truth[0].camera_from_object;
  EXPECT_NEAR(Eigen::AngleAxisd(turn.linear()).angle(), CV_PI, 1e-6);
  EXPECT_NE(readText(folder / "board_from_object.yaml").find("board_from_object"), std::string::npos);
}

TEST(Turntable, ObjectStandsOnTheBoardEitherWayUp) {
  CatalogObject object = boxObject(4, {0.1, 0.08, 0.15}, 1);
  for (Eigen::Vector3d& p : object.shape.points) p += Eigen::Vector3d(0.02, -0.01, 0.3);
  for (const bool upside_down : {false, true}) {
    const Pose pose = boardFromObject(object, upside_down);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : object.shape.points) box.extend(pose * p);
    EXPECT_NEAR(box.center().head<2>().norm(), 0.0, 1e-9);
    EXPECT_NEAR(box.min().z(), 0.0, 1e-9);
    EXPECT_NEAR(pose(2, 2), upside_down ? -1.0 : 1.0, 1e-9);
  }
}

TEST(Turntable, RejectsObjectsLargerThanTheBoard) {
  const CatalogObject object = boxObject(4, {0.6, 0.3, 0.1}, 1);
  EXPECT_THROW(writeTurntable(object, shippedBoard("charuco.yaml"), KinectParameters(), TurntableParameters(), 1,
                              "nowhere", [](int, int) {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace recognition
