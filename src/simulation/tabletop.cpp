#include "simulation/tabletop.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "simulation/random_stream.h"
#include "simulation/room.h"

namespace recognition {
namespace {

constexpr double kDegree = CV_PI / 180.0;
constexpr double kFallTime = 0.5;      // s until the next body is put
constexpr double kRestTime = 5.0;      // s
constexpr double kMaxOverlap = 0.003;  // m
constexpr double kEdge = 0.12;         // m from the table's edge that things are put
constexpr double kTableThickness = 0.03;
constexpr int kViews = 20;         // tried per arrangement
constexpr double kHidden = 0.75;   // visible share below which an object counts as hidden
constexpr int kHidingTries = 60;   // arrangements after which a scene may do without a hidden object
constexpr int kSearchScale = 4;  // visibility is searched for at a quarter of the depth's resolution
constexpr double kDepthMargin =
    0.06;  // share of the image without depth at each border: the infrared camera sees less than the colour camera

Eigen::Matrix3d randomRotation(cv::RNG& rng) {
  Eigen::Quaterniond q(rng.gaussian(1.0), rng.gaussian(1.0), rng.gaussian(1.0), rng.gaussian(1.0));
  return q.normalized().toRotationMatrix();
}

// Upright mostly, else on another side or any way.
Eigen::Matrix3d startRotation(cv::RNG& rng) {
  const Eigen::AngleAxisd yaw(rng.uniform(0.0, 2 * CV_PI), Eigen::Vector3d::UnitZ());
  const double kind = rng.uniform(0.0, 1.0);
  if (kind < 0.6) return yaw.toRotationMatrix();
  if (kind > 0.9) return randomRotation(rng);
  const Eigen::Vector3d axis = rng.uniform(0, 2) ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  return yaw * Eigen::AngleAxisd(rng.uniform(1, 4) * CV_PI / 2, axis).toRotationMatrix();
}

class Arrangement {
 public:
  Arrangement(const Eigen::Vector2d& table, const TabletopParameters& parameters, double radius)
      : table_(table), parameters_(parameters), radius_(radius) {
    world_.addFixedBox({table.x(), table.y(), kTableThickness}, Pose(Eigen::Translation3d(0, 0, -kTableThickness / 2)));
    world_.addFixedBox({20.0, 20.0, 0.2}, Pose(Eigen::Translation3d(0, 0, kFloorHeight - 0.1)));
  }

  void put(const CatalogObject& object, cv::RNG& rng) {
    Eigen::Matrix3d rotation = startRotation(rng);
    const double angle = rng.uniform(0.0, 2 * CV_PI);
    const double reach = radius_ * std::sqrt(rng.uniform(0.0, 1.0));
    const Eigen::Vector2d limit = 0.5 * table_ - Eigen::Vector2d::Constant(kEdge);
    Eigen::Vector2d place =
        Eigen::Vector2d(reach * std::cos(angle), reach * std::sin(angle)).cwiseMin(limit).cwiseMax(-limit);
    if (count_ > 0 && rng.uniform(0.0, 1.0) < parameters_.stacking) {
      place = world_.pose(rng.uniform(0, count_)).translation().head<2>();
    } else if (count_ > 0 && rng.uniform(0.0, 1.0) < parameters_.leaning) {
      const Eigen::Vector3d axis(place.y(), -place.x(), 0.0);  // tips towards the middle
      rotation = Eigen::AngleAxisd(rng.uniform(0.3, 0.8), axis.normalized()) * rotation;
    }
    Pose pose = Pose::Identity();
    pose.linear() = rotation;
    pose.translation() << place, topUnder(object, rotation, place) + 0.004 - lowestPoint(object.shape, rotation);
    world_.addBody(object.shape, pose, rng.uniform(0.5, 0.9));
    ++count_;
    world_.run(kFallTime);
  }

  /// At rest and not inside one another. What fell off the table lies on the floor.
  bool settled() { return world_.settle(kRestTime) && world_.deepestOverlap() < kMaxOverlap; }

  bool onTable(int body) const { return world_.bounds(body).min().z() > -0.01; }

  Pose pose(int body) const { return world_.pose(body); }

 private:
  // Height of what is already there under a body.
  double topUnder(const CatalogObject& object, const Eigen::Matrix3d& rotation, const Eigen::Vector2d& place) const {
    Eigen::AlignedBox2d footprint;
    for (const Eigen::Vector3d& p : object.shape.points)
      footprint.extend(Eigen::Vector2d((rotation * p).head<2>() + place));
    double top = 0.0;
    for (int i = 0; i < count_; ++i) {
      const Eigen::AlignedBox3d box = world_.bounds(i);
      const Eigen::AlignedBox2d other(Eigen::Vector2d(box.min().head<2>()), Eigen::Vector2d(box.max().head<2>()));
      if (footprint.intersects(other)) top = std::max(top, box.max().z());
    }
    return top;
  }

  PhysicsWorld world_;
  Eigen::Vector2d table_;
  const TabletopParameters& parameters_;
  double radius_;
  int count_ = 0;
};

Eigen::Vector3d middle(const Scene& scene, const std::vector<int>& bodies) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int body : bodies) sum += scene.bodies[static_cast<size_t>(body)].world_from_body.translation();
  return bodies.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(bodies.size()));
}

Pose drawView(const Eigen::Vector3d& about, const TabletopParameters& p, cv::RNG& rng) {
  const double tilt = kDegree * rng.uniform(p.min_tilt, p.max_tilt);
  const double azimuth = rng.uniform(0.0, 2 * CV_PI);
  const double span = p.max_distance - p.min_distance;
  const double distance = p.min_distance + span * (0.05 + 0.85 * 0.5 * (rng.uniform(0.0, 1.0) + rng.uniform(0.0, 1.0)));
  const Eigen::Vector3d target =
      about + Eigen::Vector3d(rng.uniform(-0.08, 0.08), rng.uniform(-0.08, 0.08), rng.uniform(0.0, 0.08));
  const Eigen::Vector3d back(std::cos(tilt) * std::cos(azimuth), std::cos(tilt) * std::sin(azimuth), std::sin(tilt));
  return lookAt(target + distance * back, target, kDegree * rng.uniform(-p.max_roll, p.max_roll));
}

CameraModel searchCamera(const CameraModel& depth_camera) { return depth_camera.scaled(1.0 / kSearchScale); }

// Least visible share of the objects, 0 if one is too near or too far.
double leastVisible(const Scene& scene, const std::vector<int>& objects, const CameraModel& camera,
                    const TabletopParameters& p) {
  const RayScene rays(scene);
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
  double least = 1.0;
  for (const int body : objects) least = std::min(least, measureVisibility(rays, camera, covered, body).fraction());
  return least;
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
      doubleParameter("spread", "m", &spread, 0.01, 1.0, "radius of the heap for one body"),
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

TabletopScene furnish(const Room& room) {
  TabletopScene result;
  result.scene.bodies = room.bodies;
  result.scene.lamps = room.lamps;
  result.scene.ambient_above = room.ambient_above;
  result.scene.ambient_below = room.ambient_below;
  return result;
}

// Puts the bodies behind those of the room; the first `objects` of them must stay on the table. False if they do not
// come to rest there.
bool arrange(const std::vector<const CatalogObject*>& bodies, size_t objects, const Room& room,
             const TabletopParameters& parameters, double relief, cv::RNG& rng, TabletopScene& result) {
  const double radius = relief * parameters.spread * std::sqrt(static_cast<double>(bodies.size()));
  Arrangement arrangement(room.table_size, parameters, radius);
  const std::vector<size_t> order = shuffledOrder(bodies.size(), rng);
  for (const size_t i : order) arrangement.put(*bodies[i], rng);
  if (!arrangement.settled()) return false;
  const size_t first = room.bodies.size();
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

}  // namespace

TabletopScene composeTabletop(const std::vector<const CatalogObject*>& objects, int clutter,
                              const CameraModel& depth_camera, const TabletopParameters& parameters,
                              std::uint64_t seed) {
  parameters.validate();
  cv::RNG rng = randomStream(seed, 1);
  const Room room = makeRoom(rng);
  std::vector<CatalogObject> junk;
  for (int i = 0; i < clutter; ++i) junk.push_back(makeClutter(rng));
  std::vector<const CatalogObject*> all(objects);
  for (const CatalogObject& object : junk) all.push_back(&object);

  const bool wants_hidden = all.size() > 1 && !objects.empty() && rng.uniform(0.0, 1.0) < parameters.occlusion;

  TabletopScene result = furnish(room);
  for (int attempt = 0; attempt < 2 * parameters.max_attempts; ++attempt) {
    if (attempt == parameters.max_attempts) all.resize(objects.size());  // the clutter makes way
    cv::RNG draw = randomStream(seed, 2, static_cast<std::uint64_t>(attempt));
    const double relief = 1.0 + 0.02 * std::min(attempt, 40);  // crowded heaps get more room in the end
    if (!arrange(all, objects.size(), room, parameters, relief, draw, result)) continue;
    for (int view = 0; view < kViews; ++view) {
      result.scene.world_from_camera = drawView(middle(result.scene, result.objects), parameters, draw);
      const double least = leastVisible(result.scene, result.objects, searchCamera(depth_camera), parameters);
      const bool hidden = least < kHidden || !wants_hidden || attempt >= kHidingTries;
      if (hidden && least > 1.05 * parameters.min_visibility) return result;  // room for the coarse sampling
    }
  }
  throw std::runtime_error("no arrangement of " + std::to_string(objects.size()) + " objects in " +
                           std::to_string(2 * parameters.max_attempts) + " attempts shows every one enough");
}

}  // namespace recognition
