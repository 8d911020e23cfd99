#include "simulation/fixture.h"

#include "simulation/shapes.h"
#include "simulation/textures.h"

namespace recognition {
namespace {

constexpr double kShelfWalls = 0.7;  // m: nothing that stands in a shelf falls over them

// Four walls about `inner` (m), or three with the side at -y open.
void addSides(Fixture& fixture, const Eigen::Vector2d& inner, double height, double thickness, bool front) {
  const double x = (inner.x() + thickness) / 2, y = (inner.y() + thickness) / 2, z = height / 2;
  for (const double side : {-1.0, 1.0}) {
    fixture.walls.push_back({{thickness, inner.y() + 2 * thickness, height}, {side * x, 0, z}});
    if (side > 0 || front) fixture.walls.push_back({{inner.x(), thickness, height}, {0, side * y, z}});
  }
}

Fixture makeTote(cv::RNG& rng) {
  Fixture fixture;
  const Eigen::Vector2d inner(rng.uniform(0.34, 0.6), rng.uniform(0.26, 0.42));
  const double height = rng.uniform(0.08, 0.22);
  addSides(fixture, inner, height, rng.uniform(0.004, 0.012), true);
  fixture.half = inner / 2;
  fixture.min_tilt = 45.0;
  fixture.max_tilt = 85.0;
  return fixture;
}

Fixture makeShelf(cv::RNG& rng) {
  Fixture fixture;
  const Eigen::Vector2d inner(rng.uniform(0.35, 0.9), rng.uniform(0.25, 0.42));
  fixture.board = rng.uniform(0.012, 0.025);
  fixture.roof_gap = rng.uniform(0.02, 0.2);
  addSides(fixture, inner, kShelfWalls, fixture.board, false);
  fixture.half = inner / 2;
  fixture.min_azimuth = -CV_PI / 2 - 0.6;
  fixture.max_azimuth = -CV_PI / 2 + 0.6;
  fixture.min_tilt = 2.0;
  fixture.max_tilt = 35.0;
  return fixture;
}

cv::Mat wallTexture(Enclosure kind, bool blank, cv::RNG& rng) {
  if (blank || rng.uniform(0.0, 1.0) < 0.4) return cv::Mat(16, 16, CV_8UC3, cv::Scalar::all(rng.uniform(190.0, 250.0)));
  const bool wood = kind == Enclosure::kShelf && rng.uniform(0.0, 1.0) < 0.6;
  return makeMaterialTexture(wood ? MaterialKind::kWood : MaterialKind::kPlain, 512, rng);
}

}  // namespace

Fixture makeFixture(Enclosure kind, bool blank, cv::RNG& rng) {
  if (kind == Enclosure::kNone) return {};
  Fixture fixture = kind == Enclosure::kTote ? makeTote(rng) : makeShelf(rng);
  fixture.texture = wallTexture(kind, blank, rng);
  fixture.finish.specular = static_cast<float>(rng.uniform(0.01, 0.12));
  return fixture;
}

std::vector<SceneBody> fixtureBodies(const Fixture& fixture, double top) {
  std::vector<Fixture::Wall> seen = fixture.walls;
  if (fixture.roof_gap > 0.0) {
    const double height = top + fixture.roof_gap;
    for (Fixture::Wall& wall : seen) wall.size.z() = 2 * (wall.middle.z() = height / 2);
    seen.push_back({{2 * (fixture.half.x() + fixture.board), 2 * fixture.half.y() + fixture.board, fixture.board},
                    {0, fixture.board / 2, height + fixture.board / 2}});
  }
  std::vector<SceneBody> bodies;
  for (const Fixture::Wall& wall : seen)
    bodies.push_back({std::make_shared<BodyAppearance>(
                          std::make_shared<const TexturedMesh>(makeBox(wall.size, fixture.texture)), fixture.finish),
                      Pose(Eigen::Translation3d(wall.middle)), 0});
  return bodies;
}

}  // namespace recognition
