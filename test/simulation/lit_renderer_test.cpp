#include "simulation/lit_renderer.h"

#include <gtest/gtest.h>

#include "simulation/fixtures.h"

namespace recognition {
namespace {

const CameraModel kCamera{160, 120, 140, 140, 79.5, 59.5};

// A gray floor seen from straight above, a lamp 1 m above its middle, no ambient light.
Scene floorUnderLamp() {
  Scene scene;
  scene.ambient_above = scene.ambient_below = Eigen::Vector3f::Zero();
  scene.bodies.push_back({makeAppearance(makeTiledPlane(4, 4, 1, plainTexture(186))), Pose::Identity(), 0});
  scene.lamps.push_back({{0, 0, 1}, 0.001f, {0.2f, 0.4f, 0.8f}});
  scene.world_from_camera = lookAt({0, 0, 0.9}, {0, 0, 0});
  return scene;
}

TEST(LitRenderer, ObeysLambertAndTheInverseSquare) {
  const Scene scene = floorUnderLamp();
  const cv::Mat light = renderRadiance(RayScene(scene), kCamera);
  const double albedo = std::pow(186 / 255.0, 2.2);
  const auto middle = light.at<cv::Vec3f>(60, 80);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(middle[c], albedo * scene.lamps[0].power[c], 0.01 * scene.lamps[0].power[c]);
  const double x = (150 - 79.5) / 140 * 0.9;
  const double expected = albedo * 0.8 * std::pow(1 + x * x, -1.5);
  EXPECT_NEAR(light.at<cv::Vec3f>(60, 150)[2], expected, 0.01 * expected);
}

TEST(LitRenderer, LampsCastSoftShadows) {
  Scene scene = floorUnderLamp();
  scene.lamps[0].position = {-0.6f, 0, 1};
  scene.lamps[0].radius = 0.05f;
  const cv::Mat open = renderRadiance(RayScene(scene), kCamera);
  scene.bodies.push_back(
      {makeAppearance(makeBox({0.1, 0.1, 0.02}, plainTexture(186))), Pose(Eigen::Translation3d(0, 0, 0.2)), 0});
  const cv::Mat light = renderRadiance(RayScene(scene), kCamera);
  int dark = 0, half = 0;
  for (int u = 91; u < 160; ++u) {  // right of the box the floor is seen, and its shadow between x = 0.09 and 0.21 m
    const double share = light.at<cv::Vec3f>(60, u)[1] / open.at<cv::Vec3f>(60, u)[1];
    dark += share < 0.02;
    half += share > 0.2 && share < 0.8;
  }
  EXPECT_GT(dark, 5);
  EXPECT_GT(half, 0);
}

TEST(LitRenderer, CornersSeeLessAmbientLight) {
  Scene scene = floorUnderLamp();
  scene.lamps.clear();
  scene.ambient_above = Eigen::Vector3f::Constant(0.5f);
  scene.bodies.push_back(
      {makeAppearance(makeBox({0.3, 0.3, 0.3}, plainTexture(186))), Pose(Eigen::Translation3d(0.3, 0, 0.1)), 0});
  const cv::Mat light = renderRadiance(RayScene(scene), kCamera);
  const int foot = static_cast<int>(79.5 + 140 * 0.14 / 0.9);
  EXPECT_LT(light.at<cv::Vec3f>(60, foot - 1)[1], 0.85 * light.at<cv::Vec3f>(60, 20)[1]);
}

TEST(LitRenderer, GlossMirrorsTheLamp) {
  Scene scene = floorUnderLamp();
  scene.world_from_camera = lookAt({0, -0.5, 0.9}, {0, 0, 0});
  const cv::Mat matt = renderRadiance(RayScene(scene), kCamera);
  scene.bodies[0].appearance = makeAppearance(makeTiledPlane(4, 4, 1, plainTexture(186)), {0.3f, 100.0f, 0.5f});
  const cv::Mat gloss = renderRadiance(RayScene(scene), kCamera);
  double matt_max = 0.0, gloss_max = 0.0;
  cv::minMaxLoc(matt.reshape(1), nullptr, &matt_max);
  cv::minMaxLoc(gloss.reshape(1), nullptr, &gloss_max);
  EXPECT_GT(gloss_max, 1.5 * matt_max);
}

TEST(LitRenderer, SameForAnyNumberOfThreads) {
  const Scene scene = floorUnderLamp();
  const RayScene rays(scene);
  cv::setNumThreads(1);
  const cv::Mat one = renderRadiance(rays, kCamera);
  cv::setNumThreads(8);
  EXPECT_TRUE(sameBits(one, renderRadiance(rays, kCamera)));
}

TEST(LitRenderer, RejectsWhatItCannotRender) {
  Scene scene = floorUnderLamp();
  EXPECT_THROW(renderRadiance(RayScene(scene), kCamera, 0), std::invalid_argument);
  scene.lamps.resize(8);
  EXPECT_THROW(renderRadiance(RayScene(scene), kCamera), std::invalid_argument);
  EXPECT_THROW(makeAppearance(TexturedMesh()), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
