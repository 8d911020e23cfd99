#include "simulation/ray_scene.h"

#include <algorithm>
#include <map>

#include "meshes/embree_rays.h"

namespace recognition {
namespace {

// One thread builds: a build's result may otherwise depend on the number of threads.
RTCDevice device() {
  static const RTCDevice shared = rtcNewDevice("threads=1,set_affinity=0");
  return shared;
}

RTCScene buildMesh(const TexturedMesh& mesh) {
  RTCGeometry geometry = makeGeometry(device(), mesh);
  RTCScene scene = rtcNewScene(device());
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

}  // namespace

class RayScene::Impl {
 public:
  explicit Impl(const Scene& scene) : scene_(scene), top_(rtcNewScene(device())) {
    rtcSetSceneFlags(top_, RTC_SCENE_FLAG_ROBUST);
    for (const SceneBody& body : scene.bodies) {
      RTCScene& mesh = meshes_[&body.appearance->mesh()];
      if (!mesh) mesh = buildMesh(body.appearance->mesh());
      attach(mesh, body.world_from_body.cast<float>());
    }
    rtcCommitScene(top_);
  }

  ~Impl() {
    rtcReleaseScene(top_);
    for (const auto& mesh : meshes_) rtcReleaseScene(mesh.second);
  }

  SurfaceHit cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
    const RTCRayHit query = firstHit(top_, origin, direction);
    SurfaceHit point;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return point;
    point.body = static_cast<int>(query.hit.instID[0]);
    point.triangle = query.hit.primID;
    point.weights = {1.0f - query.hit.u - query.hit.v, query.hit.u, query.hit.v};
    point.distance = query.ray.tfar;
    point.position = origin + query.ray.tfar * direction;
    const Eigen::Vector3f geometric =
        Eigen::Vector3f(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).stableNormalized();
    const auto& appearance = *scene_.bodies[query.hit.instID[0]].appearance;
    point.normal = rotations_[query.hit.instID[0]] * appearance.normal(point.triangle, point.weights, geometric);
    if (point.normal.dot(direction) > 0.0f) point.normal = -point.normal;
    return point;
  }

  bool meetsAlone(int body, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
    const auto index = static_cast<size_t>(body);
    const Eigen::Matrix3f body_from_world = rotations_[index].transpose();
    return isBlocked(meshes_.at(&scene_.bodies[index].appearance->mesh()),
                     body_from_world * (origin - translations_[index]), body_from_world * direction);
  }

  bool blocked(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float offset) const {
    const Eigen::Vector3f direction = to - from;
    const float share = offset / std::max(direction.norm(), 1e-6f);
    return isBlocked(top_, from, direction, share, 1.0f - share);
  }

  const Scene& scene_;

 private:
  void attach(RTCScene mesh, const Eigen::Isometry3f& world_from_body) {
    RTCGeometry instance = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, mesh);
    const Eigen::Matrix4f matrix = world_from_body.matrix();
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, matrix.data());
    rtcCommitGeometry(instance);
    rtcAttachGeometry(top_, instance);  // ids count up from 0: the body's index
    rtcReleaseGeometry(instance);
    rotations_.push_back(world_from_body.linear());
    translations_.push_back(world_from_body.translation());
  }

  RTCScene top_;
  std::map<const TexturedMesh*, RTCScene> meshes_;
  std::vector<Eigen::Matrix3f> rotations_;
  std::vector<Eigen::Vector3f> translations_;
};

RayScene::RayScene(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
RayScene::~RayScene() = default;

const Scene& RayScene::scene() const { return impl_->scene_; }

SurfaceHit RayScene::cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
  return impl_->cast(origin, direction);
}

bool RayScene::meetsAlone(int body, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
  return impl_->meetsAlone(body, origin, direction);
}

bool RayScene::blocked(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float offset) const {
  return impl_->blocked(from, to, offset);
}

}  // namespace recognition
