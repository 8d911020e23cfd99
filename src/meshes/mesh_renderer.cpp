#include "meshes/mesh_renderer.h"

#include <map>
#include <stdexcept>

#include "meshes/embree_rays.h"
#include "meshes/textured_surface.h"

namespace recognition {
namespace {

RTCDevice device() {
  static const RTCDevice shared = rtcNewDevice(nullptr);
  return shared;
}

}  // namespace

class MeshRenderer::Impl {
 public:
  explicit Impl(const std::vector<MeshInstance>& instances) : scene_(rtcNewScene(device())) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    std::map<const TexturedMesh*, std::shared_ptr<const TexturedSurface>> known;
    for (const MeshInstance& instance : instances) {
      if (!instance.mesh) throw std::invalid_argument("an instance has no mesh");
      auto& surface = known[instance.mesh.get()];
      if (!surface) surface = std::make_shared<TexturedSurface>(instance.mesh);
      surfaces_.push_back(surface);
      rotations_.push_back(instance.camera_from_object.linear().cast<float>());
      RTCGeometry geometry = makeGeometry(device(), *instance.mesh, instance.camera_from_object);
      rtcAttachGeometry(scene_, geometry);  // ids count up from 0: the instance's index
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene_);
  }

  ~Impl() { rtcReleaseScene(scene_); }

  RTCRayHit find(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
    return firstHit(scene_, origin, direction);
  }

  // All but the colour.
  RayHit describe(const RTCRayHit& query, const Eigen::Vector3f& direction) const {
    RayHit result;
    result.distance = query.ray.tfar;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return result;
    result.instance = static_cast<int>(query.hit.geomID);
    const Eigen::Matrix3f& rotation = rotations_[query.hit.geomID];
    const Eigen::Vector3f geometric =
        Eigen::Vector3f(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).stableNormalized();
    result.normal = rotation * surfaces_[query.hit.geomID]->normalAt(query.hit.primID, weightsOf(query),
                                                                     rotation.transpose() * geometric);
    if (result.normal.dot(direction) > 0.0f) result.normal = -result.normal;
    return result;
  }

  // `width_at_one`: metres that the ray's share of the pixel covers at distance 1.
  Eigen::Vector3f colorAt(const RTCRayHit& query, float width_at_one, float width) const {
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return Eigen::Vector3f::Zero();
    return surfaces_[query.hit.geomID]->colorAt(query.hit.primID, weightsOf(query),
                                                width + width_at_one * query.ray.tfar);
  }

  bool occluded(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
    return isBlocked(scene_, origin, direction);
  }

 private:
  static Eigen::Vector3f weightsOf(const RTCRayHit& query) {
    return {1.0f - query.hit.u - query.hit.v, query.hit.u, query.hit.v};
  }

  RTCScene scene_;
  std::vector<std::shared_ptr<const TexturedSurface>> surfaces_;  // by instance
  std::vector<Eigen::Matrix3f> rotations_;
};

namespace {

cv::Vec3b toPixel(const Eigen::Vector3f& bgr) {
  return {cv::saturate_cast<uchar>(bgr[0]), cv::saturate_cast<uchar>(bgr[1]), cv::saturate_cast<uchar>(bgr[2])};
}

// Mean colour of samples x samples rays through the pixel (u, v).
template <typename ColorAt>
Eigen::Vector3f sampleColor(const ColorAt& colorAt, int u, int v, int samples) {
  Eigen::Vector3f bgr = Eigen::Vector3f::Zero();
  for (int s = 0; s < samples * samples; ++s)
    bgr += colorAt(u + (s % samples + 0.5) / samples - 0.5, v + (s / samples + 0.5) / samples - 0.5);
  return bgr / static_cast<float>(samples * samples);
}

}  // namespace

MeshRenderer::MeshRenderer(const std::vector<MeshInstance>& instances) : impl_(std::make_unique<Impl>(instances)) {}
MeshRenderer::~MeshRenderer() = default;

bool MeshRenderer::occluded(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
  return impl_->occluded(origin, direction);
}

RayHit MeshRenderer::cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float texture_width) const {
  const RTCRayHit query = impl_->find(origin, direction);
  RayHit hit = impl_->describe(query, direction);
  hit.bgr = impl_->colorAt(query, 0.0f, texture_width);
  return hit;
}

RenderedView MeshRenderer::render(const CameraModel& camera, int samples, const Pose& camera_from_scene) const {
  camera.validate();
  if (samples < 1) throw std::invalid_argument("samples is " + std::to_string(samples) + ": must be 1 or more");
  const cv::Size size(camera.width, camera.height);
  RenderedView view{cv::Mat(size, CV_8UC3), cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC3), cv::Mat(size, CV_32SC1)};
  const Eigen::Matrix3f camera_rotation = camera_from_scene.linear().cast<float>();
  const Eigen::Vector3f origin = camera_from_scene.inverse().translation().cast<float>();
  const auto width_at_one = static_cast<float>(1.0 / (camera.fx * samples));
  const Eigen::Matrix3f scene_rotation = camera_rotation.transpose();
  const auto rayThrough = [&](double u, double v) -> Eigen::Vector3f {
    return scene_rotation * camera.unproject(u, v, 1.0).cast<float>();
  };
  const auto colorAt = [&](double u, double v) {
    return impl_->colorAt(impl_->find(origin, rayThrough(u, v)), width_at_one, 0.0f);
  };
  const auto renderPixel = [&](int u, int v) {
    const Eigen::Vector3f direction = rayThrough(u, v);
    const RTCRayHit query = impl_->find(origin, direction);
    const RayHit centre = impl_->describe(query, direction);
    const Eigen::Vector3f normal = camera_rotation * centre.normal;
    view.depth.at<float>(v, u) = centre.hit() ? centre.distance : 0.0f;  // directions have z = 1
    view.normals.at<cv::Vec3f>(v, u) = {normal.x(), normal.y(), normal.z()};
    view.instance.at<int>(v, u) = centre.instance;
    view.color.at<cv::Vec3b>(v, u) =
        toPixel(samples > 1 ? sampleColor(colorAt, u, v, samples) : impl_->colorAt(query, width_at_one, 0.0f));
  };
  cv::parallel_for_(cv::Range(0, camera.height), [&](const cv::Range& rows) {
    for (int v = rows.start; v < rows.end; ++v)
      for (int u = 0; u < camera.width; ++u) renderPixel(u, v);
  });
  return view;
}

}  // namespace recognition
