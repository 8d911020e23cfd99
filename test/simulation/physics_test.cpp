#include "simulation/physics.h"

#include <gtest/gtest.h>

#include "simulation/fixtures.h"

namespace recognition {
namespace {

Pose at(double x, double y, double z) { return Pose(Eigen::Translation3d(x, y, z)); }

struct TableWorld : PhysicsWorld {
  TableWorld() { addFixedBox({1.5, 1.5, 0.2}, at(0, 0, -0.1)); }
};

TEST(ConvexShape, KeepsCornersAndCentre) {
  TexturedMesh mesh = makeBox({0.1, 0.2, 0.3}, plainTexture(100));
  for (auto& vertex : mesh.vertices) vertex += Eigen::Vector3f(1, 2, 3);
  const RigidShape shape = convexShape(mesh);
  EXPECT_GE(shape.points.size(), 8u);
  EXPECT_NEAR((shape.centre - Eigen::Vector3d(1, 2, 3)).norm(), 0.0, 1e-6);
  EXPECT_NEAR(lowestPoint(shape, Eigen::Matrix3d::Identity()), 2.85, 1e-6);
  EXPECT_THROW(convexShape(TexturedMesh()), std::invalid_argument);
}

TEST(PhysicsWorld, BoxesComeToRestOnTableAndOnOneAnother) {
  TableWorld world;
  const RigidShape shape = convexShape(makeBox({0.1, 0.1, 0.06}, plainTexture(100)));
  const int lower = world.addBody(shape, at(0, 0, 0.05));
  world.run(0.5);
  const int upper = world.addBody(shape, at(0.01, 0.01, 0.13));
  EXPECT_TRUE(world.settle(5.0));
  EXPECT_NEAR(world.pose(lower).translation().z(), 0.03, 0.0015);
  EXPECT_NEAR(world.pose(upper).translation().z(), 0.09, 0.003);
  EXPECT_LT(world.deepestOverlap(), 0.001);
}

TEST(PhysicsWorld, BodiesOffTheirCentreOfMassFallOver) {
  TableWorld world;
  const RigidShape shape = convexShape(makeBox({0.05, 0.05, 0.2}, plainTexture(100)));
  const Pose tilted = at(0, 0, 0.13) * Pose(Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY()));
  const int body = world.addBody(shape, tilted);
  EXPECT_TRUE(world.settle(5.0));
  EXPECT_NEAR(world.pose(body).translation().z(), 0.025, 0.002);
}

TEST(PhysicsWorld, SameCallsSamePoses) {
  Pose results[2];
  for (Pose& result : results) {
    TableWorld world;
    const RigidShape shape = convexShape(makeCylinder(0.04, 0.12, plainTexture(100)));
    for (int i = 0; i < 4; ++i) {
      world.addBody(shape, at(0.01 * i, 0.0, 0.1 + 0.13 * i));
      world.run(0.2);
    }
    world.settle(4.0);
    result = world.pose(3);
  }
  EXPECT_TRUE(results[0].matrix() == results[1].matrix());
}

}  // namespace
}  // namespace recognition
