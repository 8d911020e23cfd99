#include "rgbd_recognition/model/mesh_renderer.h"

#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include <embree3/rtcore.h>

#include "rgbd_recognition/model/texture_pyramid.h"

namespace rgbd_recognition {
namespace {

const Eigen::Vector3f kUntextured(128.0f, 128.0f, 128.0f);

RTCDevice device() {
  static const RTCDevice shared = rtcNewDevice(nullptr);
  return shared;
}

// The index of a ray's instance is its geometry id: geometries are attached in order.
RTCGeometry makeGeometry(const MeshInstance& instance) {
  const TexturedMesh& mesh = *instance.mesh;
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.vertices.size()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                      3 * sizeof(std::uint32_t), mesh.triangles.size()));
  if (!vertices || !indices) throw std::runtime_error("Embree has no memory for a mesh");
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    Eigen::Map<Eigen::Vector3f>(vertices + 3 * i) = (instance.camera_from_object * mesh.vertices[i].cast<double>()).cast<float>();
  for (size_t i = 0; i < mesh.triangles.size(); ++i) std::copy(mesh.triangles[i].begin(), mesh.triangles[i].end(), indices + 3 * i);
  rtcCommitGeometry(geometry);
  return geometry;
}

// Texels of the finest level a metre of each triangle.
std::vector<float> texelDensities(const TexturedMesh& mesh, cv::Size size) {
  std::vector<float> densities;
  densities.reserve(mesh.triangles.size());
  const Eigen::Array2f scale(static_cast<float>(size.width), static_cast<float>(size.height));
  for (const auto& t : mesh.triangles) {
    const Eigen::Array2f a = (mesh.texture_coordinates[t[1]] - mesh.texture_coordinates[t[0]]).array() * scale;
    const Eigen::Array2f b = (mesh.texture_coordinates[t[2]] - mesh.texture_coordinates[t[0]]).array() * scale;
    const Eigen::Vector3f p = mesh.vertices[t[1]] - mesh.vertices[t[0]];
    const Eigen::Vector3f q = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    const float area = p.cross(q).norm();
    densities.push_back(area > 0.0f ? std::sqrt(std::abs(a.x() * b.y() - a.y() * b.x()) / area) : 0.0f);
  }
  return densities;
}

// What the instances of one mesh share.
struct Surface {
  std::shared_ptr<const TexturedMesh> mesh;
  std::unique_ptr<TexturePyramid> texture;
  std::vector<float> densities;

  explicit Surface(std::shared_ptr<const TexturedMesh> textured_mesh) : mesh(std::move(textured_mesh)) {
    if (mesh->texture.empty() || mesh->texture_coordinates.empty()) return;
    texture = std::make_unique<TexturePyramid>(*mesh);
    densities = texelDensities(*mesh, texture->size());
  }

  Eigen::Vector3f colorAt(std::uint32_t triangle, const Eigen::Vector3f& weights, float width) const {
    const auto& t = mesh->triangles[triangle];
    const auto mean = [&](const auto& values) { return weights[0] * values[t[0]] + weights[1] * values[t[1]] + weights[2] * values[t[2]]; };
    if (texture) return texture->sample(Eigen::Vector2f(mean(mesh->texture_coordinates)), width * densities[triangle]);
    if (mesh->vertex_colors.empty()) return kUntextured;
    Eigen::Vector3f bgr = Eigen::Vector3f::Zero();
    for (int k = 0; k < 3; ++k) {
      const cv::Vec3b& rgb = mesh->vertex_colors[t[static_cast<size_t>(k)]];
      bgr += weights[k] * Eigen::Vector3f(rgb[2], rgb[1], rgb[0]);
    }
    return bgr;
  }

  Eigen::Vector3f normalAt(std::uint32_t triangle, const Eigen::Vector3f& weights, const Eigen::Vector3f& geometric) const {
    if (mesh->normals.empty()) return geometric;
    const auto& t = mesh->triangles[triangle];
    const Eigen::Vector3f normal = weights[0] * mesh->normals[t[0]] + weights[1] * mesh->normals[t[1]] + weights[2] * mesh->normals[t[2]];
    return normal.allFinite() && normal.norm() > 0.1f ? normal.normalized() : geometric;
  }
};

}  // namespace

class MeshRenderer::Impl {
 public:
  explicit Impl(const std::vector<MeshInstance>& instances) : scene_(rtcNewScene(device())) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    std::map<const TexturedMesh*, std::shared_ptr<const Surface>> known;
    for (const MeshInstance& instance : instances) {
      if (!instance.mesh) throw std::invalid_argument("an instance has no mesh");
      auto& surface = known[instance.mesh.get()];
      if (!surface) surface = std::make_shared<Surface>(instance.mesh);
      surfaces_.push_back(surface);
      rotations_.push_back(instance.camera_from_object.linear().cast<float>());
      RTCGeometry geometry = makeGeometry(instance);
      rtcAttachGeometry(scene_, geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene_);
  }

  ~Impl() { rtcReleaseScene(scene_); }

  // `width_at_one`: metres that the ray's share of the pixel covers at distance 1.
  RayHit cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float width_at_one, float width) const {
    RTCRayHit query = trace(origin, direction);
    RayHit result;
    result.distance = query.ray.tfar;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return result;
    result.instance = static_cast<int>(query.hit.geomID);
    const Surface& surface = *surfaces_[query.hit.geomID];
    const Eigen::Vector3f weights(1.0f - query.hit.u - query.hit.v, query.hit.u, query.hit.v);
    const Eigen::Matrix3f& rotation = rotations_[query.hit.geomID];
    const Eigen::Vector3f geometric = Eigen::Vector3f(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).stableNormalized();
    result.normal = rotation * surface.normalAt(query.hit.primID, weights, rotation.transpose() * geometric);
    if (result.normal.dot(direction) > 0.0f) result.normal = -result.normal;
    result.bgr = surface.colorAt(query.hit.primID, weights, width + width_at_one * query.ray.tfar);
    return result;
  }

 private:
  RTCRayHit trace(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray.org_x = origin.x();
    query.ray.org_y = origin.y();
    query.ray.org_z = origin.z();
    query.ray.dir_x = direction.x();
    query.ray.dir_y = direction.y();
    query.ray.dir_z = direction.z();
    query.ray.tfar = std::numeric_limits<float>::infinity();
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &query);
    return query;
  }

  RTCScene scene_;
  std::vector<std::shared_ptr<const Surface>> surfaces_;  // by instance
  std::vector<Eigen::Matrix3f> rotations_;
};

namespace {

cv::Vec3b toPixel(const Eigen::Vector3f& bgr) {
  return {cv::saturate_cast<uchar>(bgr[0]), cv::saturate_cast<uchar>(bgr[1]), cv::saturate_cast<uchar>(bgr[2])};
}

}  // namespace

MeshRenderer::MeshRenderer(const std::vector<MeshInstance>& instances) : impl_(std::make_unique<Impl>(instances)) {}
MeshRenderer::~MeshRenderer() = default;

RayHit MeshRenderer::cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float texture_width) const {
  return impl_->cast(origin, direction, 0.0f, texture_width);
}

RenderedView MeshRenderer::render(const CameraModel& camera, int samples, const Pose& camera_from_scene) const {
  camera.validate();
  if (samples < 1) throw std::invalid_argument("samples is " + std::to_string(samples) + ": must be 1 or more");
  const cv::Size size(camera.width, camera.height);
  RenderedView view{cv::Mat(size, CV_8UC3), cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC3), cv::Mat(size, CV_32SC1)};
  const Eigen::Matrix3f camera_rotation = camera_from_scene.linear().cast<float>();
  const Eigen::Vector3f origin = camera_from_scene.inverse().translation().cast<float>();
  const auto width_at_one = static_cast<float>(1.0 / (camera.fx * samples));
  const auto castPixel = [&](double u, double v) {
    const Eigen::Vector3f direction = camera_rotation.transpose() * camera.unproject(u, v, 1.0).cast<float>();
    return impl_->cast(origin, direction, width_at_one, 0.0f);
  };
  cv::parallel_for_(cv::Range(0, camera.height), [&](const cv::Range& rows) {
    for (int v = rows.start; v < rows.end; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const RayHit centre = castPixel(u, v);
        const Eigen::Vector3f normal = camera_rotation * centre.normal;
        view.depth.at<float>(v, u) = centre.hit() ? centre.distance : 0.0f;  // directions have z = 1
        view.normals.at<cv::Vec3f>(v, u) = {normal.x(), normal.y(), normal.z()};
        view.instance.at<int>(v, u) = centre.instance;
        Eigen::Vector3f bgr = centre.bgr;
        if (samples > 1) {
          bgr.setZero();
          for (int s = 0; s < samples * samples; ++s)
            bgr += castPixel(u + (s % samples + 0.5) / samples - 0.5, v + (s / samples + 0.5) / samples - 0.5).bgr;
          bgr /= static_cast<float>(samples * samples);
        }
        view.color.at<cv::Vec3b>(v, u) = toPixel(bgr);
      }
    }
  });
  return view;
}

}  // namespace rgbd_recognition
