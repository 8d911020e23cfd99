#include "simulation/world.h"

#include <gtest/gtest.h>

#include "simulation/arrangement.h"
#include "simulation/fixtures.h"

namespace recognition {
namespace {

TEST(World, HardLeavesTheSensorAlone) {
  KinectParameters base;
  base.color.blur = 0.77;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const FrameWorld frame = drawFrameWorld(World::of(WorldPreset::kHard), base, seed);
    EXPECT_EQ(frame.kinect.text(), base.text());
    EXPECT_EQ(frame.tabletop.enclosure, Enclosure::kNone);
    EXPECT_EQ(frame.many, 0);
  }
}

TEST(World, WideDrawsEverythingWithinItsRanges) {
  const World world = World::of(WorldPreset::kWide);
  std::map<Enclosure, int> enclosures;
  int blank = 0, many = 0, short_range = 0;
  double farthest = 0.0, largest_scale = 0.0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const FrameWorld frame = drawFrameWorld(world, KinectParameters(), seed);
    EXPECT_NO_THROW(frame.kinect.validate());
    EXPECT_NO_THROW(frame.tabletop.validate());
    ++enclosures[frame.tabletop.enclosure];
    blank += frame.tabletop.blank;
    many += frame.many > 0;
    short_range += frame.kinect.depth.baseline < 0.05;
    farthest = std::max(farthest, std::hypot(frame.kinect.depth.registration_x, frame.kinect.depth.registration_y));
    largest_scale = std::max(largest_scale, std::abs(frame.kinect.depth.scale - 1.0));
  }
  EXPECT_NEAR(enclosures[Enclosure::kShelf], 120, 40);
  EXPECT_NEAR(enclosures[Enclosure::kTote], 100, 40);
  EXPECT_NEAR(blank, 140, 40);
  EXPECT_NEAR(many, 60, 30);
  EXPECT_NEAR(short_range, 140, 40);
  EXPECT_GT(farthest, 2.8);
  EXPECT_LE(farthest, 3.0);
  EXPECT_GT(largest_scale, 0.018);
  EXPECT_LE(largest_scale, 0.02);
}

TEST(World, SameSeedSameDraw) {
  const World world = World::of(WorldPreset::kWide);
  const auto text = [&world](std::uint64_t seed) {
    return drawFrameWorld(world, KinectParameters(), seed).kinect.text();
  };
  EXPECT_EQ(text(3), text(3));
  EXPECT_NE(text(3), text(4));
}

TEST(Aging, FadesAndGreysTheTextureOnly) {
  cv::RNG rng(1);
  CatalogObject object;
  object.appearance = makeAppearance(makeBox({0.1, 0.1, 0.1}, cv::Mat(8, 8, CV_8UC3, cv::Scalar(0, 0, 255))));
  const auto albedo = [](const CatalogObject& o) { return o.appearance->albedo(0, {0.4f, 0.3f, 0.3f}, 0.001f); };
  EXPECT_TRUE(albedo(object).isApprox(Eigen::Vector3f(0, 0, 1), 1e-3f));

  Finish faded = object.appearance->finish();
  faded.fade = 0.5f;
  object.appearance = std::make_shared<BodyAppearance>(*object.appearance, faded);
  EXPECT_TRUE(albedo(object).isApprox(Eigen::Vector3f(0.375f, 0.375f, 0.875f), 1e-3f)) << albedo(object).transpose();

  faded.chroma = 0.0f;
  object.appearance = std::make_shared<BodyAppearance>(*object.appearance, faded);
  EXPECT_NEAR(albedo(object)[0], 0.299f * 0.875f + 0.701f * 0.375f, 1e-3f);
  EXPECT_NEAR(albedo(object)[0], albedo(object)[2], 1e-5f);

  const CatalogObject same = age(object, Aging(), rng);
  EXPECT_EQ(&same.appearance->mesh(), &object.appearance->mesh());
}

class Fixtures : public testing::TestWithParam<Enclosure> {};

TEST_P(Fixtures, KeepThingsInside) {
  TabletopParameters parameters;
  parameters.enclosure = GetParam();
  parameters.contact = 1.0;
  parameters.stacking = 0.0;
  cv::RNG rng(5);
  const Fixture fixture = makeFixture(GetParam(), true, rng);
  const CatalogObject box = boxObject(1, {0.06, 0.04, 0.05}, 1);
  Arrangement arrangement({1.5, 1.0}, fixture, parameters, 0.1);
  for (int i = 0; i < 4; ++i) arrangement.put(box, rng);
  ASSERT_TRUE(arrangement.settled());
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d at = arrangement.pose(i).translation();
    EXPECT_LT(std::abs(at.x()), fixture.half.x());
    EXPECT_LT(std::abs(at.y()), fixture.half.y());
  }
  for (const SceneBody& wall : fixtureBodies(fixture, arrangement.top())) {
    EXPECT_EQ(wall.object_id, 0);
    EXPECT_GT(wall.world_from_body.translation().z(), 0.0);
  }
  EXPECT_EQ(fixtureBodies(fixture, 0.1).size(), 4u);  // four sides, or three and a roof
}

INSTANTIATE_TEST_SUITE_P(Enclosures, Fixtures, testing::Values(Enclosure::kTote, Enclosure::kShelf),
                         [](const auto& info) { return info.param == Enclosure::kTote ? "Tote" : "Shelf"; });

TEST(Contact, PutsThingsSideBySide) {
  TabletopParameters parameters;
  parameters.contact = 1.0;
  cv::RNG rng(2);
  const CatalogObject box = boxObject(1, {0.1, 0.1, 0.1}, 1);
  int touching = 0;
  for (int scene = 0; scene < 5; ++scene) {
    Arrangement arrangement({1.5, 1.0}, Fixture(), parameters, 0.05);
    for (int i = 0; i < 2; ++i) arrangement.put(box, rng);
    if (!arrangement.settled()) continue;
    const Eigen::Vector3d gap = arrangement.pose(0).translation() - arrangement.pose(1).translation();
    touching += std::abs(gap.z()) < 0.01 && gap.norm() > 0.095 && gap.norm() < 0.16;
  }
  EXPECT_GE(touching, 4);
}

}  // namespace
}  // namespace recognition
