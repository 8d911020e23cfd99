#include "simulation/visibility.h"

#include <gtest/gtest.h>

#include "simulation/fixtures.h"

namespace recognition {
namespace {

const CameraModel kCamera{320, 240, 280, 280, 159.5, 119.5};

SceneBody boxAt(double x, double y, double z) {
  return {makeAppearance(makeBox({0.2, 0.2, 0.002}, plainTexture(100))), Pose(Eigen::Translation3d(x, y, z)), 1};
}

BodyVisibility visibilityOf(const Scene& scene, int body) {
  const RayScene rays(scene);
  return measureVisibility(rays, kCamera, renderBodies(rays, kCamera), body);
}

TEST(Visibility, CountsWhatIsInTheWay) {
  Scene scene;
  scene.bodies = {boxAt(0, 0, 1), boxAt(0.06, 0, 0.6)};  // the nearer one covers from x = -0.04 * 1 / 0.6 on
  const BodyVisibility behind = visibilityOf(scene, 0);
  EXPECT_NEAR(behind.all, 56 * 56, 120);
  EXPECT_NEAR(behind.fraction(), (0.1 - 0.04 / 0.6) / 0.2, 0.02);
  EXPECT_DOUBLE_EQ(visibilityOf(scene, 1).fraction(), 1.0);
  EXPECT_LT(behind.box_visible.width, behind.box_all.width);
}

TEST(Visibility, CountsWhatLeavesTheImage) {
  Scene scene;
  scene.bodies = {boxAt(160.0 / 280, 0, 1)};  // centred on the image's border
  const BodyVisibility cut = visibilityOf(scene, 0);
  EXPECT_NEAR(cut.fraction(), 0.5, 0.02);
  EXPECT_GT(cut.box_all.br().x, kCamera.width);
}

TEST(Visibility, BehindTheCameraIsInvisible) {
  Scene scene;
  scene.bodies = {boxAt(0, 0, -1)};
  EXPECT_EQ(visibilityOf(scene, 0).fraction(), 0.0);
}

}  // namespace
}  // namespace recognition
