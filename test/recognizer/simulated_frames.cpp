#include "recognizer/simulated_frames.h"

#include "simulation/annotate.h"
#include "simulation/fixture.h"
#include "simulation/fixtures.h"
#include "simulation/room.h"

namespace recognition {
namespace {

constexpr double kShelfTop = 0.26;  // metres: higher than the objects

KinectParameters quick(KinectParameters kinect) {
  kinect.color_mode = ColorMode::kVga;
  kinect.samples = 1;
  return kinect;
}

void add(Scene* scene, TexturedMesh mesh, const Pose& world_from_body, int object_id = 0) {
  scene->bodies.push_back({makeAppearance(std::move(mesh)), world_from_body, object_id});
}

Pose turnedAt(double x, double y, double z, double yaw) {
  return Eigen::Translation3d(x, y, z) * Pose(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
}

void addFlatThings(Scene* scene, cv::RNG& rng) {
  add(scene, makeBox({0.42, 0.015, 0.24}, plainTexture(235)), turnedAt(0.0, 0.11, 0.12, 0.0));
  for (const double x : {-0.14, 0.12})
    add(scene, makePrintedPlane(0.15, 0.21, makePrintTexture({300, 420}, rng)),
        turnedAt(x, -0.13, 0.001, rng.uniform(-0.5, 0.5)));
}

/// Side by side, before the board.
std::vector<int> addBoxes(const std::vector<CatalogObject>& catalog, Scene* scene, cv::RNG& rng) {
  std::vector<int> bodies;
  double x = -0.2;
  for (const CatalogObject& object : catalog) {
    const MeshBox box = boxOf(object);
    bodies.push_back(static_cast<int>(scene->bodies.size()));
    add(scene, makeBox(box.size, makePrintTexture({384, 256}, rng)),
        turnedAt(x + 0.5 * box.size.x(), 0.02, 0.5 * box.size.z(), rng.uniform(-0.3, 0.3)), object.id);
    x += box.size.x() + 0.02;
  }
  return bodies;
}

}  // namespace

std::vector<CatalogObject> demoCatalog() { return loadCatalog(RGBD_TEST_DATA "/demo/models"); }

AnnotatedFrame simulatedFrame(const std::vector<CatalogObject>& catalog, WorldPreset preset, std::uint64_t seed) {
  World exact = World::of(preset);
  exact.parameters.depth_scale = exact.parameters.misregistration = 0.0;
  const FrameWorld world = drawFrameWorld(exact, KinectParameters(), seed);
  const SimulatedKinect kinect(quick(world.kinect));
  cv::RNG rng = randomStream(seed, 5);
  std::vector<CatalogObject> aged;
  for (const CatalogObject& object : catalog) aged.push_back(age(object, world.aging, rng));
  std::vector<const CatalogObject*> objects;
  for (const CatalogObject& object : aged) objects.push_back(&object);
  const TabletopScene scene = composeTabletop(objects, 2, kinect.depthCamera(), world.tabletop, seed);
  return captureAnnotated(scene.scene, scene.objects, kinect, seed, seed);
}

AnnotatedFrame decoyFrame(const std::vector<CatalogObject>& catalog, const DecoyScene& decoys, std::uint64_t seed) {
  cv::RNG rng = randomStream(seed, 7);
  const Room room = makeRoom(rng, decoys.blank);
  Scene scene;
  scene.bodies = room.bodies;
  scene.lamps = room.lamps;
  scene.ambient_above = room.ambient_above;
  scene.ambient_below = room.ambient_below;
  if (decoys.shelf)
    for (const SceneBody& board : fixtureBodies(makeFixture(Enclosure::kShelf, decoys.blank, rng), kShelfTop))
      scene.bodies.push_back(board);
  addFlatThings(&scene, rng);
  const std::vector<int> boxes = addBoxes(catalog, &scene, rng);
  scene.world_from_camera = lookAt({rng.uniform(-0.15, 0.15), -0.85, rng.uniform(0.3, 0.45)}, {0.0, 0.0, 0.08});
  return captureAnnotated(scene, boxes, SimulatedKinect(quick({})), seed, seed);
}

MeshBox boxOf(const CatalogObject& object) {
  const auto& vertices = object.appearance->mesh().vertices;
  Eigen::Vector3f low = vertices.front(), high = vertices.front();
  for (const Eigen::Vector3f& vertex : vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  return {0.5 * (low + high).cast<double>(), (high - low).cast<double>()};
}

}  // namespace recognition
