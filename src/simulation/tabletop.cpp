#include "simulation/tabletop.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "simulation/arrangement.h"
#include "simulation/degree.h"
#include "simulation/random_stream.h"
#include "simulation/room.h"

namespace recognition {
namespace {

constexpr int kViews = 20;        // tried per arrangement
constexpr double kHidden = 0.75;  // visible share below which an object counts as hidden
constexpr int kHidingTries = 60;  // arrangements after which a scene may do without a hidden object
constexpr int kSearchScale = 4;   // visibility is searched for at a quarter of the depth's resolution
constexpr double kDepthMargin =
    0.06;  // share of the image without depth at each border: the infrared camera sees less than the colour camera

Eigen::Vector3d middle(const Scene& scene, const std::vector<int>& bodies) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int body : bodies) sum += scene.bodies[static_cast<size_t>(body)].world_from_body.translation();
  return bodies.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(bodies.size()));
}

Pose drawView(const Eigen::Vector3d& about, const TabletopParameters& p, const Fixture& fixture, cv::RNG& rng) {
  const bool open = fixture.max_tilt <= 0.0;
  const double tilt = kDegree * rng.uniform(open ? p.min_tilt : fixture.min_tilt, open ? p.max_tilt : fixture.max_tilt);
  const double azimuth = rng.uniform(fixture.min_azimuth, fixture.max_azimuth);
  const double span = p.max_distance - p.min_distance;
  const double distance = p.min_distance + span * (0.05 + 0.85 * 0.5 * (rng.uniform(0.0, 1.0) + rng.uniform(0.0, 1.0)));
  const Eigen::Vector3d target =
      about + Eigen::Vector3d(rng.uniform(-0.08, 0.08), rng.uniform(-0.08, 0.08), rng.uniform(0.0, 0.08));
  const Eigen::Vector3d back(std::cos(tilt) * std::cos(azimuth), std::cos(tilt) * std::sin(azimuth), std::sin(tilt));
  return lookAt(target + distance * back, target, kDegree * rng.uniform(-p.max_roll, p.max_roll));
}

CameraModel searchCamera(const CameraModel& depth_camera) { return depth_camera.scaled(1.0 / kSearchScale); }

// The share of its silhouette that all but a few of the objects show (`seen_share`), 0 if one is too near or too far.
double visibleShare(const RayScene& rays, const std::vector<int>& objects, const CameraModel& camera,
                    const TabletopParameters& p) {
  const Scene& scene = rays.scene();
  const Eigen::Vector3d eye = scene.world_from_camera.translation();
  for (const int body : objects) {
    const double distance = (scene.bodies[static_cast<size_t>(body)].world_from_body.translation() - eye).norm();
    if (distance < p.min_distance || distance > p.max_distance) return 0.0;
  }
  cv::Mat bodies = renderBodies(rays, camera);
  const int mu = cvCeil(kDepthMargin * camera.width);
  const int mv = cvCeil(kDepthMargin * camera.height);
  cv::Mat covered(bodies.size(), CV_32SC1, cv::Scalar(-1));
  const cv::Rect inner(mu, mv, camera.width - 2 * mu, camera.height - 2 * mv);
  bodies(inner).copyTo(covered(inner));
  std::vector<double> shares{1.0};
  for (const int body : objects) shares.push_back(measureVisibility(rays, camera, covered, body).fraction());
  std::sort(shares.begin(), shares.end());
  return shares[static_cast<size_t>((1.0 - p.seen_share) * static_cast<double>(objects.size()))];
}

}  // namespace

ParameterList TabletopParameters::list() {
  return {
      doubleParameter("min_distance", "m", &min_distance, 0.1, 10.0, "least distance of an object from the camera"),
      doubleParameter("max_distance", "m", &max_distance, 0.1, 10.0, "greatest distance of an object from the camera"),
      doubleParameter("min_tilt", "deg", &min_tilt, 0.0, 89.0, "least angle that the camera looks down"),
      doubleParameter("max_tilt", "deg", &max_tilt, 0.0, 89.0, "greatest angle that the camera looks down"),
      doubleParameter("max_roll", "deg", &max_roll, 0.0, 180.0, "greatest turn about the optical axis"),
      doubleParameter("min_visibility", "", &min_visibility, 0.0, 0.95,
                      "least visible share of each object's silhouette"),
      doubleParameter("occlusion", "", &occlusion, 0.0, 1.0,
                      "share of scenes in which an object must be hidden by more than a quarter"),
      doubleParameter("stacking", "", &stacking, 0.0, 1.0, "share of bodies put onto others"),
      doubleParameter("leaning", "", &leaning, 0.0, 1.0, "share of bodies tipped against others"),
      doubleParameter("contact", "", &contact, 0.0, 1.0, "share of bodies put side by side with others"),
      doubleParameter("seen_share", "", &seen_share, 0.0, 1.0, "share of the objects that must be visible"),
      doubleParameter("spread", "m", &spread, 0.01, 1.0, "radius of the heap for one body"),
      choiceParameter("enclosure", &enclosure, {"none", "tote", "shelf"}, "what stands about the things"),
      boolParameter("blank", &blank, "table, walls, tote and shelf are white"),
      doubleParameter("printed_clutter", "", &clutter.printed, 0.0, 1.0, "share of clutter with an invented print"),
      doubleParameter("blank_clutter", "", &clutter.blank, 0.0, 1.0, "share of clutter that is blank and white"),
      intParameter("max_attempts", "", &max_attempts, 1, 100000,
                   "arrangements tried before the clutter is left out, and then before giving up"),
  };
}

void TabletopParameters::validate() const {
  TabletopParameters copy = *this;
  validateParameters(copy.list(), "tabletop");
  if (min_distance >= max_distance) throw std::invalid_argument("tabletop/min_distance is not below max_distance");
  if (min_tilt >= max_tilt) throw std::invalid_argument("tabletop/min_tilt is not below max_tilt");
}

namespace {

std::vector<size_t> shuffledOrder(size_t count, cv::RNG& rng) {
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  for (size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[static_cast<size_t>(rng.uniform(0, static_cast<int>(i)))]);
  return order;
}

// All that is drawn once for a scene, whatever its arrangement.
struct Stage {
  Room room;
  Fixture fixture;
  std::vector<CatalogObject> clutter;
  bool wants_hidden = false;
};

Stage setStage(const std::vector<const CatalogObject*>& objects, int clutter, const TabletopParameters& parameters,
               std::uint64_t seed) {
  cv::RNG rng = randomStream(seed, 1);
  Stage stage;
  stage.room = makeRoom(rng, parameters.blank);
  for (int i = 0; i < clutter; ++i) stage.clutter.push_back(makeClutter(parameters.clutter, rng));
  stage.wants_hidden =
      objects.size() + stage.clutter.size() > 1 && !objects.empty() && rng.uniform(0.0, 1.0) < parameters.occlusion;
  cv::RNG walls = randomStream(seed, 3);
  stage.fixture = makeFixture(parameters.enclosure, parameters.blank, walls);
  return stage;
}

TabletopScene furnish(const Room& room) {
  TabletopScene result;
  result.scene.lamps = room.lamps;
  result.scene.ambient_above = room.ambient_above;
  result.scene.ambient_below = room.ambient_below;
  return result;
}

// Puts the bodies behind those of the room; the first `objects` of them must stay on the table. False if they do not
// come to rest there.
bool arrange(const std::vector<const CatalogObject*>& bodies, size_t objects, const Stage& stage,
             const TabletopParameters& parameters, double relief, cv::RNG& rng, TabletopScene& result) {
  const double radius = relief * parameters.spread * std::sqrt(static_cast<double>(bodies.size()));
  Arrangement arrangement(stage.room.table_size, stage.fixture, parameters, radius);
  const std::vector<size_t> order = shuffledOrder(bodies.size(), rng);
  for (const size_t i : order) arrangement.put(*bodies[i], rng);
  if (!arrangement.settled()) return false;
  result.scene.bodies = stage.room.bodies;
  for (SceneBody& wall : fixtureBodies(stage.fixture, arrangement.top()))
    result.scene.bodies.push_back(std::move(wall));
  const size_t first = result.scene.bodies.size();
  result.scene.bodies.resize(first + bodies.size());
  for (size_t k = 0; k < order.size(); ++k) {
    const CatalogObject& body = *bodies[order[k]];
    const auto index = static_cast<int>(k);
    if (order[k] < objects && !arrangement.onTable(index)) return false;
    result.scene.bodies[first + order[k]] = {body.appearance, arrangement.pose(index), body.id};
  }
  result.objects.clear();
  for (size_t i = 0; i < objects; ++i) result.objects.push_back(static_cast<int>(first + i));
  return true;
}

// A view that shows the arrangement well enough becomes the scene's camera.
bool findView(const Fixture& fixture, const CameraModel& camera, const TabletopParameters& parameters,
              bool wants_hidden, cv::RNG& rng, TabletopScene& result) {
  const RayScene rays(result.scene);  // follows the scene's camera
  const Eigen::Vector3d about = middle(result.scene, result.objects);
  for (int view = 0; view < kViews; ++view) {
    result.scene.world_from_camera = drawView(about, parameters, fixture, rng);
    const double share = visibleShare(rays, result.objects, camera, parameters);
    if ((share < kHidden || !wants_hidden) && share > 1.05 * parameters.min_visibility)
      return true;  // room for the coarse sampling
  }
  return false;
}

}  // namespace

TabletopScene composeTabletop(const std::vector<const CatalogObject*>& objects, int clutter,
                              const CameraModel& depth_camera, const TabletopParameters& parameters,
                              std::uint64_t seed) {
  parameters.validate();
  const Stage stage = setStage(objects, clutter, parameters, seed);
  std::vector<const CatalogObject*> all(objects);
  for (const CatalogObject& object : stage.clutter) all.push_back(&object);
  const CameraModel camera = searchCamera(depth_camera);
  TabletopScene result = furnish(stage.room);
  for (int attempt = 0; attempt < 2 * parameters.max_attempts; ++attempt) {
    if (attempt == parameters.max_attempts) all.resize(objects.size());  // the clutter makes way
    cv::RNG draw = randomStream(seed, 2, static_cast<std::uint64_t>(attempt));
    const double relief = 1.0 + 0.02 * std::min(attempt, 40);  // crowded heaps get more room in the end
    if (!arrange(all, objects.size(), stage, parameters, relief, draw, result)) continue;
    const bool hidden = stage.wants_hidden && attempt < kHidingTries;
    if (findView(stage.fixture, camera, parameters, hidden, draw, result)) return result;
  }
  throw UnarrangeableScene("no arrangement of " + std::to_string(objects.size()) + " objects in " +
                           std::to_string(2 * parameters.max_attempts) + " attempts shows every one enough");
}

}  // namespace recognition
