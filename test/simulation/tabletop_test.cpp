#include "simulation/tabletop.h"

#include <gtest/gtest.h>

#include "simulation/fixtures.h"

namespace recognition {
namespace {

class Tabletop : public testing::Test {
 protected:
  Tabletop() : kinect_(KinectParameters()) {
    objects_ = {boxObject(1, {0.16, 0.06, 0.21}, 1), boxObject(2, {0.09, 0.05, 0.17}, 1),
                boxObject(3, {0.1, 0.1, 0.1}, 1)};
    for (const auto& object : objects_) wanted_.push_back(&object);
  }

  TabletopScene compose(std::uint64_t seed) const {
    return composeTabletop(wanted_, 2, kinect_.depthCamera(), parameters_, seed);
  }

  SimulatedKinect kinect_;
  TabletopParameters parameters_;
  std::vector<CatalogObject> objects_;
  std::vector<const CatalogObject*> wanted_;
};

TEST_F(Tabletop, KeepsItsPromises) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const TabletopScene composed = compose(seed);
    ASSERT_EQ(composed.objects.size(), 3u);
    const RayScene rays(composed.scene);
    const cv::Mat bodies = renderBodies(rays, kinect_.depthCamera());
    const Pose& camera = composed.scene.world_from_camera;
    const double tilt = std::asin(-camera.linear()(2, 2)) * 180 / CV_PI;
    EXPECT_GE(tilt, parameters_.min_tilt);
    EXPECT_LE(tilt, parameters_.max_tilt);
    for (size_t i = 0; i < 3; ++i) {
      const SceneBody& body = composed.scene.bodies[static_cast<size_t>(composed.objects[i])];
      EXPECT_EQ(body.object_id, objects_[i].id);
      const double lowest =
          body.world_from_body.translation().z() + lowestPoint(objects_[i].shape, body.world_from_body.linear());
      EXPECT_GT(lowest, -0.002) << "seed " << seed << " object " << i << " sinks into the table";
      EXPECT_GE(measureVisibility(rays, kinect_.depthCamera(), bodies, composed.objects[i]).fraction(),
                parameters_.min_visibility);
      const double distance = (body.world_from_body.translation() - camera.translation()).norm();
      EXPECT_GE(distance, parameters_.min_distance);
      EXPECT_LE(distance, parameters_.max_distance);
    }
  }
}

TEST_F(Tabletop, HidesAnObjectWhereAsked) {
  const auto least = [&](double occlusion, std::uint64_t seed) {
    parameters_.occlusion = occlusion;
    const TabletopScene composed = compose(seed);
    const RayScene rays(composed.scene);
    const cv::Mat bodies = renderBodies(rays, kinect_.depthCamera());
    double fraction = 1.0;
    for (const int object : composed.objects)
      fraction = std::min(fraction, measureVisibility(rays, kinect_.depthCamera(), bodies, object).fraction());
    return fraction;
  };
  double free = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    EXPECT_LT(least(1.0, seed), 0.8) << "seed " << seed;
    free = std::max(free, least(0.0, seed));
  }
  EXPECT_GT(free, 0.9);
}

TEST_F(Tabletop, SameSeedSameScene) {
  const TabletopScene a = compose(5), b = compose(5), c = compose(6);
  EXPECT_TRUE(a.scene.world_from_camera.matrix() == b.scene.world_from_camera.matrix());
  EXPECT_FALSE(a.scene.world_from_camera.matrix() == c.scene.world_from_camera.matrix());
  for (size_t i = 0; i < a.scene.bodies.size(); ++i)
    EXPECT_TRUE(a.scene.bodies[i].world_from_body.matrix() == b.scene.bodies[i].world_from_body.matrix());
}

TEST_F(Tabletop, GivesUpOnTheImpossible) {
  parameters_.max_distance = 0.12;
  parameters_.min_distance = 0.1;
  parameters_.max_attempts = 2;
  EXPECT_THROW(compose(1), std::runtime_error);
  parameters_.min_tilt = 80;
  EXPECT_THROW(compose(1), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
