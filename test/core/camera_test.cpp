#include "rgbd_recognition/core/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"

namespace recognition {
namespace {

CameraModel kinect() { return {640, 480, 525.0, 525.0, 319.5, 239.5}; }

TEST(CameraModel, ProjectsByEquation2) {
  // m = C p / z by hand: u = 525 * 0.2 / 1.5 + 319.5, v = 525 * (-0.1) / 1.5 + 239.5
  const Eigen::Vector2d m = kinect().project({0.2, -0.1, 1.5});
  EXPECT_NEAR(m.x(), 389.5, 1e-9);
  EXPECT_NEAR(m.y(), 204.5, 1e-9);
}

TEST(CameraModel, UnprojectInvertsProject) {
  const Eigen::Vector3d p(-0.3, 0.25, 1.2);
  const Eigen::Vector2d m = kinect().project(p);
  EXPECT_NEAR((kinect().unproject(m.x(), m.y(), 1.2) - p).norm(), 0.0, 1e-12);
}

TEST(CameraModel, ScalingKeepsRays) {
  // The centre of a depth pixel is the centre of its 2x2 colour pixels: (10, 20) -> (20.5, 40.5).
  const CameraModel twice = kinect().scaled(2.0);
  EXPECT_EQ(twice.width, 1280);
  EXPECT_NEAR((twice.unproject(20.5, 40.5, 1.0) - kinect().unproject(10, 20, 1.0)).norm(), 0.0, 1e-12);
}

TEST(CameraModel, ValidateNamesField) {
  CameraModel camera = kinect();
  camera.fy = std::nan("");
  EXPECT_THAT(refusal([&] { camera.validate(); }), testing::HasSubstr("fy"));
}

}  // namespace
}  // namespace recognition
