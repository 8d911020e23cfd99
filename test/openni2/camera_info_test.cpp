#include <gtest/gtest.h>

#include <cmath>

#include "camera/openni2_camera_info.h"

namespace recognition {
namespace {

const double kFieldOfView = 2.0 * std::atan(320.0 / 525.0);

TEST(CameraInfo, DefaultIsAKinectsIdealCamera) {
  const sensor_msgs::CameraInfo info = defaultCameraInfo(640, 480, kFieldOfView);
  EXPECT_EQ(640u, info.width);
  EXPECT_NEAR(525.0, info.K[0], 1e-9);
  EXPECT_NEAR(525.0, info.P[5], 1e-9);
  EXPECT_NEAR(319.5, info.P[2], 1e-9);
  EXPECT_NEAR(239.5, info.P[6], 1e-9);
  EXPECT_EQ("plumb_bob", info.distortion_model);
}

TEST(CameraInfo, SxgaSeesTheSameAsVgaAndRowsBelow) {
  const sensor_msgs::CameraInfo info = defaultCameraInfo(1280, 1024, kFieldOfView);
  EXPECT_NEAR(1050.0, info.K[0], 1e-9);
  EXPECT_NEAR(639.5, info.K[2], 1e-9);
  EXPECT_NEAR(479.5, info.K[5], 1e-9);
}

TEST(CameraInfo, ScalesACalibrationSoThatThePixelsRaysStay) {
  sensor_msgs::CameraInfo calibration = defaultCameraInfo(640, 480, kFieldOfView);
  calibration.K[2] = calibration.P[2] = 310.0;
  calibration.D[0] = 0.1;
  const sensor_msgs::CameraInfo info = scaledCameraInfo(calibration, 1280, 1024);
  EXPECT_EQ(1280u, info.width);
  EXPECT_EQ(1024u, info.height);
  EXPECT_NEAR(1050.0, info.K[0], 1e-9);
  // the centre of pixel 310 is the edge between pixels 620 and 621 of the doubled image
  EXPECT_NEAR(620.5, info.K[2], 1e-9);
  EXPECT_NEAR(620.5, info.P[2], 1e-9);
  EXPECT_DOUBLE_EQ(1.0, info.K[8]);
  EXPECT_DOUBLE_EQ(0.1, info.D[0]);
}

TEST(CameraInfo, ProjectorLiesBesideTheInfraredCamera) {
  const sensor_msgs::CameraInfo info = projectorInfo(defaultCameraInfo(640, 480, kFieldOfView), 0.075);
  EXPECT_NEAR(-525.0 * 0.075, info.P[3], 1e-9);
}

}  // namespace
}  // namespace recognition
