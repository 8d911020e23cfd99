#include "simulation/arrangement.h"

#include <algorithm>
#include <cmath>

#include "simulation/room.h"

namespace recognition {
namespace {

constexpr double kFallTime = 0.3;      // s until the next body is put
constexpr double kRestTime = 3.0;      // s
constexpr double kMaxOverlap = 0.003;  // m
constexpr double kEdge = 0.12;         // m from the table's edge that things are put
constexpr double kContactGap = 0.001;  // m between things that are put beside one another
constexpr double kTableThickness = 0.03;

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

Eigen::AlignedBox3d rotatedBox(const RigidShape& shape, const Eigen::Matrix3d& rotation) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : shape.points) box.extend(rotation * p);
  return box;
}

}  // namespace

Arrangement::Arrangement(const Eigen::Vector2d& table, const Fixture& fixture, const TabletopParameters& parameters,
                         double radius)
    : table_(table), fixture_(fixture), parameters_(parameters), radius_(radius) {
  world_.addFixedBox({table.x(), table.y(), kTableThickness}, Pose(Eigen::Translation3d(0, 0, -kTableThickness / 2)));
  world_.addFixedBox({20.0, 20.0, 0.2}, Pose(Eigen::Translation3d(0, 0, kFloorHeight - 0.1)));
  for (const Fixture::Wall& wall : fixture.walls)
    world_.addFixedBox(wall.size, Pose(Eigen::Translation3d(wall.middle)));
}

void Arrangement::put(const CatalogObject& object, cv::RNG& rng) {
  Placement placement = drawPlacement(object, rng);
  if (parameters_.enclosure != Enclosure::kNone) placement.place = within(object, placement);
  Pose pose = Pose::Identity();
  pose.linear() = placement.rotation;
  pose.translation() << placement.place,
      topUnder(object, placement) + 0.004 - lowestPoint(object.shape, placement.rotation);
  world_.addBody(object.shape, pose, rng.uniform(0.5, 0.9));
  ++count_;
  world_.run(kFallTime);
}

bool Arrangement::settled() { return world_.settle(kRestTime) && world_.deepestOverlap() < kMaxOverlap; }

double Arrangement::top() const {
  double top = 0.0;
  for (int i = 0; i < count_; ++i) top = std::max(top, world_.bounds(i).max().z());
  return top;
}

Arrangement::Placement Arrangement::drawPlacement(const CatalogObject& object, cv::RNG& rng) const {
  if (count_ > 0 && parameters_.contact > 0.0 && rng.uniform(0.0, 1.0) < parameters_.contact)
    return besideAnother(object, rng);
  Placement placement{startRotation(rng), {}};
  const double angle = rng.uniform(0.0, 2 * CV_PI);
  const double reach = radius_ * std::sqrt(rng.uniform(0.0, 1.0));
  const Eigen::Vector2d limit = 0.5 * table_ - Eigen::Vector2d::Constant(kEdge);
  placement.place = Eigen::Vector2d(reach * std::cos(angle), reach * std::sin(angle)).cwiseMin(limit).cwiseMax(-limit);
  if (count_ > 0 && rng.uniform(0.0, 1.0) < parameters_.stacking) {
    placement.place = world_.pose(rng.uniform(0, count_)).translation().head<2>();
  } else if (count_ > 0 && rng.uniform(0.0, 1.0) < parameters_.leaning) {
    const Eigen::Vector3d axis(placement.place.y(), -placement.place.x(), 0.0);  // tips towards the middle
    placement.rotation = Eigen::AngleAxisd(rng.uniform(0.3, 0.8), axis.normalized()) * placement.rotation;
  }
  return placement;
}

// Side by side with one that is there, in line with it.
Arrangement::Placement Arrangement::besideAnother(const CatalogObject& object, cv::RNG& rng) const {
  const int other = rng.uniform(0, count_);
  const Eigen::Matrix3d turned = world_.pose(other).linear();
  const double yaw = std::atan2(turned(1, 0), turned(0, 0)) + rng.uniform(0, 4) * CV_PI / 2 + rng.gaussian(0.03);
  Placement placement{Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix(), {}};
  const Eigen::AlignedBox3d own = rotatedBox(object.shape, placement.rotation);
  const Eigen::AlignedBox3d there = world_.bounds(other);
  const int axis = rng.uniform(0, 2);
  const double side = rng.uniform(0, 2) ? 1.0 : -1.0;
  Eigen::Vector2d middle = there.center().head<2>();
  middle[axis] += side * (0.5 * (there.sizes()[axis] + own.sizes()[axis]) + kContactGap);
  middle[1 - axis] += rng.uniform(-0.3, 0.3) * there.sizes()[1 - axis];
  placement.place = middle - own.center().head<2>();
  return placement;
}

// The nearest place where the whole body is inside the fixture's walls.
Eigen::Vector2d Arrangement::within(const CatalogObject& object, const Placement& placement) const {
  const Eigen::AlignedBox3d own = rotatedBox(object.shape, placement.rotation);
  const Eigen::Vector2d limit = (fixture_.half - own.sizes().head<2>() / 2).cwiseMax(0.0);
  const Eigen::Vector2d offset = own.center().head<2>();
  return Eigen::Vector2d(placement.place + offset).cwiseMin(limit).cwiseMax(-limit) - offset;
}

// Height of what is already there under a body.
double Arrangement::topUnder(const CatalogObject& object, const Placement& placement) const {
  Eigen::AlignedBox2d footprint;
  for (const Eigen::Vector3d& p : object.shape.points)
    footprint.extend(Eigen::Vector2d((placement.rotation * p).head<2>() + placement.place));
  double top = 0.0;
  for (int i = 0; i < count_; ++i) {
    const Eigen::AlignedBox3d box = world_.bounds(i);
    const Eigen::AlignedBox2d other(Eigen::Vector2d(box.min().head<2>()), Eigen::Vector2d(box.max().head<2>()));
    if (footprint.intersects(other)) top = std::max(top, box.max().z());
  }
  return top;
}

}  // namespace recognition
