#include "simulation/physics.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace recognition {
namespace {

constexpr double kScale = 10.0;        // Bullet's tolerances suit bodies of about a metre: it calculates in decimetres
constexpr double kStep = 1.0 / 240.0;  // s
constexpr double kMargin = 0.004;      // Bullet units: 0.4 mm
constexpr double kDensity = 400.0;     // kg/m3 of the bounding box
constexpr double kRestMove = 0.001;    // m in kRestSteps: contacts tremble a little for ever
constexpr double kRestTurn = 0.01;     // rad
constexpr int kRestSteps = 30;
constexpr double kPatience = 1.0;  // s after which friction of the air grows, so that balls and rims come to rest
constexpr int kDirections = 160;

btVector3 toBullet(const Eigen::Vector3d& p) {
  return {static_cast<btScalar>(kScale * p.x()), static_cast<btScalar>(kScale * p.y()),
          static_cast<btScalar>(kScale * p.z())};
}

btTransform toBullet(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const btQuaternion rotation(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()), static_cast<btScalar>(q.z()),
                              static_cast<btScalar>(q.w()));
  return btTransform(rotation, toBullet(pose.translation()));
}

Pose fromBullet(const btTransform& transform) {
  const btQuaternion q = transform.getRotation();
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized().toRotationMatrix();
  const btVector3& p = transform.getOrigin();
  pose.translation() = Eigen::Vector3d(p.x(), p.y(), p.z()) / kScale;
  return pose;
}

Eigen::Vector3d surfaceCentre(const TexturedMesh& mesh) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double area = (b - a).cross(c - a).norm();
    sum += area * (a + b + c).cast<double>() / 3.0;
    total += area;
  }
  return total > 0.0 ? Eigen::Vector3d(sum / total) : Eigen::Vector3d(mesh.vertices.front().cast<double>());
}

}  // namespace

RigidShape convexShape(const TexturedMesh& mesh) {
  if (mesh.triangles.empty()) throw std::invalid_argument("physics: a mesh has no triangles");
  std::set<size_t> extreme;
  for (int i = 0; i < kDirections; ++i) {  // Fibonacci sphere
    const double z = 1.0 - (2.0 * i + 1.0) / kDirections;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    const Eigen::Vector3f direction =
        Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), z).cast<float>();
    size_t best = 0;
    for (size_t v = 1; v < mesh.vertices.size(); ++v)
      if (mesh.vertices[v].dot(direction) > mesh.vertices[best].dot(direction)) best = v;
    extreme.insert(best);
  }
  RigidShape shape;
  for (const size_t v : extreme) shape.points.push_back(mesh.vertices[v].cast<double>());
  shape.centre = surfaceCentre(mesh);
  return shape;
}

double lowestPoint(const RigidShape& shape, const Eigen::Matrix3d& rotation) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& p : shape.points) lowest = std::min(lowest, (rotation * p).z());
  return lowest;
}

class PhysicsWorld::Impl {
 public:
  Impl() : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    world_.setGravity(btVector3(0, 0, static_cast<btScalar>(-9.81 * kScale)));
    world_.getSolverInfo().m_numIterations = 25;
  }

  ~Impl() {
    for (const auto& body : fixed_) world_.removeRigidBody(body.get());
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  void addFixedBox(const Eigen::Vector3d& size, const Pose& pose) {
    shapes_.push_back(std::make_unique<btBoxShape>(toBullet(size / 2)));
    fixed_.push_back(makeBody(0.0, *shapes_.back(), pose, 0.8));
    world_.addRigidBody(fixed_.back().get());
  }

  int addBody(const RigidShape& shape, const Pose& pose, double friction) {
    auto hull = std::make_unique<btConvexHullShape>();
    for (const Eigen::Vector3d& p : shape.points) hull->addPoint(toBullet(Eigen::Vector3d(p - shape.centre)), false);
    hull->setMargin(static_cast<btScalar>(kMargin));
    hull->recalcLocalAabb();
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : shape.points) box.extend(p);
    const double mass = std::clamp(kDensity * box.volume(), 0.02, 5.0);
    shapes_.push_back(std::move(hull));
    centres_.push_back(shape.centre);
    bodies_.push_back(makeBody(mass, *shapes_.back(), pose * Eigen::Translation3d(shape.centre), friction));
    btRigidBody& body = *bodies_.back();
    body.setRollingFriction(static_cast<btScalar>(0.02));
    body.setSpinningFriction(static_cast<btScalar>(0.02));
    body.setDamping(static_cast<btScalar>(0.1), static_cast<btScalar>(0.3));
    body.setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(&body);
    return static_cast<int>(bodies_.size()) - 1;
  }

  void step() { world_.stepSimulation(static_cast<btScalar>(kStep), 0); }

  void thickenAir() {
    for (const auto& body : bodies_) body->setDamping(static_cast<btScalar>(0.5), static_cast<btScalar>(0.95));
  }

  std::vector<Pose> poses() const {
    std::vector<Pose> all;
    for (size_t body = 0; body < bodies_.size(); ++body) all.push_back(pose(body));
    return all;
  }

  Pose pose(size_t body) const {
    return fromBullet(bodies_.at(body)->getWorldTransform()) * Eigen::Translation3d(-centres_[body]);
  }

  Eigen::AlignedBox3d bounds(size_t body) const {
    btVector3 min, max;
    bodies_.at(body)->getAabb(min, max);
    return {Eigen::Vector3d(min.x(), min.y(), min.z()) / kScale, Eigen::Vector3d(max.x(), max.y(), max.z()) / kScale};
  }

  double deepestOverlap() {
    world_.performDiscreteCollisionDetection();
    double deepest = 0.0;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold* manifold = dispatcher_.getManifoldByIndexInternal(i);
      for (int c = 0; c < manifold->getNumContacts(); ++c)
        deepest = std::max(deepest, -static_cast<double>(manifold->getContactPoint(c).getDistance()) / kScale);
    }
    return deepest;
  }

 private:
  static std::unique_ptr<btRigidBody> makeBody(double mass, btCollisionShape& shape, const Pose& pose,
                                               double friction) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0.0) shape.calculateLocalInertia(static_cast<btScalar>(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr, &shape, inertia);
    info.m_startWorldTransform = toBullet(pose);
    info.m_friction = static_cast<btScalar>(friction);
    info.m_restitution = 0;
    return std::make_unique<btRigidBody>(info);
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> fixed_, bodies_;
  std::vector<Eigen::Vector3d> centres_;
};

PhysicsWorld::PhysicsWorld() : impl_(std::make_unique<Impl>()) {}
PhysicsWorld::~PhysicsWorld() = default;

void PhysicsWorld::addFixedBox(const Eigen::Vector3d& size, const Pose& world_from_box) {
  impl_->addFixedBox(size, world_from_box);
}

int PhysicsWorld::addBody(const RigidShape& shape, const Pose& world_from_body, double friction) {
  return impl_->addBody(shape, world_from_body, friction);
}

void PhysicsWorld::run(double seconds) {
  for (int i = static_cast<int>(std::lround(seconds / kStep)); i > 0; --i) impl_->step();
}

bool PhysicsWorld::settle(double max_seconds) {
  const auto near = [](const Pose& a, const Pose& b) {
    return translationDistance(a, b) < kRestMove && rotationDistance(a, b) < kRestTurn;
  };
  std::vector<Pose> before = impl_->poses();
  for (double time = 0.0; time < max_seconds; time += kRestSteps * kStep) {
    if (time > kPatience) impl_->thickenAir();
    for (int i = 0; i < kRestSteps; ++i) impl_->step();
    const std::vector<Pose> after = impl_->poses();
    if (std::equal(after.begin(), after.end(), before.begin(), near)) return true;
    before = after;
  }
  return false;
}

Pose PhysicsWorld::pose(int body) const { return impl_->pose(static_cast<size_t>(body)); }

Eigen::AlignedBox3d PhysicsWorld::bounds(int body) const { return impl_->bounds(static_cast<size_t>(body)); }

double PhysicsWorld::deepestOverlap() const { return impl_->deepestOverlap(); }

}  // namespace recognition
