#include "simulation/kinect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"
#include "simulation/fixtures.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

Scene boxOnFloor() {
  Scene scene;
  scene.bodies.push_back({makeAppearance(makeTiledPlane(4, 4, 1, plainTexture(170))), Pose::Identity(), 0});
  scene.bodies.push_back(
      {makeAppearance(makeBox({0.2, 0.2, 0.2}, plainTexture(90))), Pose(Eigen::Translation3d(0, 0, 0.1)), 0});
  scene.lamps.push_back({{0.5f, -0.5f, 1.5f}, 0.1f, {1, 1, 1}});
  scene.world_from_camera = lookAt({0, -0.8, 0.9}, {0, 0, 0});
  return scene;
}

TEST(SimulatedKinect, FramesAreValidInBothModes) {
  const Scene scene = boxOnFloor();
  const RayScene rays(scene);
  for (const ColorMode mode : {ColorMode::kVga, ColorMode::kSxga}) {
    KinectParameters parameters;
    parameters.color_mode = mode;
    parameters.samples = 1;
    const SimulatedKinect kinect(parameters);
    const RgbdFrame frame = kinect.capture(rays, 1);
    EXPECT_NO_THROW(frame.validate());
    EXPECT_EQ(frame.depth.size(), cv::Size(640, 480));
    const CameraModel depth_camera = frame.depthCamera();
    EXPECT_DOUBLE_EQ(depth_camera.fx, 525.0);
    EXPECT_DOUBLE_EQ(depth_camera.cy, kinect.depthCamera().cy);
    EXPECT_GT(cv::countNonZero(frame.depth), 0.6 * 640 * 480);
  }
}

TEST(SimulatedKinect, DepthLiesOnTheScene) {
  const Scene scene = boxOnFloor();
  const RayScene rays(scene);
  KinectParameters parameters;
  parameters.color_mode = ColorMode::kVga;
  const SimulatedKinect kinect(parameters);
  const RgbdFrame frame = kinect.capture(rays, 2);
  std::vector<double> errors;
  for (int v = 100; v < 400; v += 7)
    for (int u = 100; u < 540; u += 7) {
      const int z = frame.depth.at<std::uint16_t>(v, u);
      if (z == 0) continue;
      const Eigen::Vector3d point = scene.world_from_camera * kinect.depthCamera().unproject(u, v, z / 1000.0);
      const bool floor = point.head<2>().cwiseAbs().maxCoeff() > 0.13;
      if (floor) errors.push_back(point.z());
    }
  ASSERT_GT(errors.size(), 500u);
  std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2), errors.end());
  EXPECT_NEAR(errors[errors.size() / 2], 0.0, 0.004);
}

TEST(SimulatedKinect, OneCameraExposesAlikeWhateverTheNoise) {
  const Scene scene = boxOnFloor();
  const RayScene rays(scene);
  KinectParameters parameters;
  parameters.color_mode = ColorMode::kVga;
  parameters.samples = 1;
  const SimulatedKinect kinect(parameters);
  const auto brightness = [&](std::uint64_t seed, std::uint64_t camera_seed) {
    return cv::mean(kinect.capture(rays, seed, camera_seed).color)[1];
  };
  const double first = brightness(1, 1);
  EXPECT_NEAR(brightness(2, 1), first, 1.0);
  EXPECT_GT(std::abs(brightness(1, 2) - first) + std::abs(brightness(1, 3) - first), 10.0);
  EXPECT_FALSE(cv::norm(kinect.capture(rays, 1, 1).color, kinect.capture(rays, 2, 1).color, cv::NORM_INF) == 0.0);
}

class SensorFile : public testing::TestWithParam<std::string> {};

TEST_P(SensorFile, Loads) { EXPECT_NO_THROW(KinectParameters::fromYaml(GetParam())); }

std::vector<std::string> sensorFiles() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(RGBD_SOURCE_DIR) + "/config/sensors"))
    files.push_back(entry.path().string());
  return files;
}

INSTANTIATE_TEST_SUITE_P(Shipped, SensorFile, testing::ValuesIn(sensorFiles()));

TEST(KinectParameters, RejectionsNameFileFieldAndValue) {
  const TemporaryDirectory folder;
  const std::string file = folder / "bad.yaml";
  const auto messageFor = [&file](const char* text) {
    std::ofstream(file) << text;
    return refusal([&] { KinectParameters::fromYaml(file); });
  };
  EXPECT_THAT(messageFor("depth_sensor: {baseline: -3}"),
              testing::AllOf(testing::HasSubstr("bad.yaml"), testing::HasSubstr("depth_sensor/baseline")));
  EXPECT_THAT(messageFor("depth_sensor: {basline: 1}"), testing::HasSubstr("basline"));
  EXPECT_THAT(messageFor("lidar: {x: 1}"), testing::HasSubstr("lidar"));
  EXPECT_THAT(messageFor("kinect: {color_mode: uxga}"), testing::HasSubstr("uxga"));
}

}  // namespace
}  // namespace recognition
