#include "benchmarks/printed_objects.h"

#include <cmath>
#include <random>
#include <string>

#include <opencv2/imgproc.hpp>

#include "core/depth_noise.h"
#include "simulation/shapes.h"
#include "simulation/textures.h"

namespace recognition::benchmarks {
namespace {

const cv::Size kTextureSize(480, 320);
constexpr double kColorNoise = 3.0;      // gray levels
constexpr double kColorBlur = 0.7;       // pixels
constexpr float kPointSpacing = 0.005f;  // of the cloud, metres

/// A point in the image of a texture and on the surface.
struct Corner {
  cv::Point2f pixel;
  Eigen::Vector3f point;
};

std::array<Corner, 3> cornersOf(const TexturedMesh& mesh, size_t triangle, cv::Size image) {
  std::array<Corner, 3> corners;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t vertex = mesh.triangles[triangle][i];
    const Eigen::Vector2f& t = mesh.texture_coordinates[vertex];
    const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
    corners[i] = {{t.x() * width - 0.5f, (1.0f - t.y()) * height - 0.5f}, mesh.vertices[vertex]};
  }
  return corners;
}

/// CV_32SC1: the triangle whose texture a pixel is, -1 for none.
cv::Mat triangleMap(const TexturedMesh& mesh, cv::Size image) {
  cv::Mat map(image, CV_32SC1, cv::Scalar(-1));
  for (size_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    std::vector<cv::Point> polygon;
    for (const Corner& corner : cornersOf(mesh, triangle, image))
      polygon.emplace_back(cvRound(corner.pixel.x), cvRound(corner.pixel.y));
    cv::fillConvexPoly(map, polygon, cv::Scalar(static_cast<double>(triangle)));
  }
  return map;
}

/// Adds one feature at `pixel` of a triangle; false for a triangle without area.
bool place(const std::array<Corner, 3>& corners, const Keypoint& keypoint, ModelFeatures& features) {
  const cv::Point2f a = corners[1].pixel - corners[0].pixel, b = corners[2].pixel - corners[0].pixel;
  const Eigen::Vector3f e1 = corners[1].point - corners[0].point, e2 = corners[2].point - corners[0].point;
  const float area = static_cast<float>(a.cross(b));
  const Eigen::Vector3f normal = e1.cross(e2);
  if (std::abs(area) < 1.0f || normal.norm() < 1e-9f) return false;
  const cv::Point2f p = cv::Point2f(keypoint.x, keypoint.y) - corners[0].pixel;
  const float s = static_cast<float>(p.cross(b)) / area, t = static_cast<float>(a.cross(p)) / area;
  features.positions.push_back(corners[0].point + s * e1 + t * e2);
  features.view_directions.push_back(normal.normalized());
  const cv::Point2f along(std::cos(keypoint.angle), std::sin(keypoint.angle));
  const Eigen::Vector3f direction =
      static_cast<float>(along.cross(b)) / area * e1 + static_cast<float>(a.cross(along)) / area * e2;
  features.orientations.push_back(direction.normalized());
  features.sizes.push_back(keypoint.size * std::sqrt(normal.norm() / std::abs(area)));
  features.views.push_back(1);
  return true;
}

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append(ModelFeatures& to, const ModelFeatures& from) {
  to.descriptors.push_back(from.descriptors);
  append(to.positions, from.positions);
  append(to.view_directions, from.view_directions);
  append(to.orientations, from.orientations);
  append(to.sizes, from.sizes);
  append(to.views, from.views);
}

std::vector<SurfacePoint> sampleSurface(const TexturedMesh& mesh) {
  std::vector<SurfacePoint> cloud;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3f a = mesh.vertices[triangle[0]];
    const Eigen::Vector3f e1 = mesh.vertices[triangle[1]] - a, e2 = mesh.vertices[triangle[2]] - a;
    const int steps = static_cast<int>(std::max(e1.norm(), e2.norm()) / kPointSpacing) + 1;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j)
        cloud.push_back({a + (e1 * static_cast<float>(i) + e2 * static_cast<float>(j)) / static_cast<float>(steps),
                         e1.cross(e2).normalized(), cv::Vec3b(128, 128, 128)});
  }
  return cloud;
}

Eigen::Matrix3d randomRotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

std::shared_ptr<const TexturedMesh> makeWall(cv::RNG& rng) {
  const auto kind = static_cast<MaterialKind>(rng.uniform(0, static_cast<int>(MaterialKind::kCount)));
  return std::make_shared<TexturedMesh>(makeTiledPlane(3.0, 3.0, 0.5, makeMaterialTexture(kind, 512, rng)));
}

cv::Mat noisyColor(const cv::Mat& color, cv::RNG& rng) {
  cv::Mat blurred, noise(color.size(), CV_16SC3), sum;
  cv::GaussianBlur(color, blurred, {}, kColorBlur);
  rng.fill(noise, cv::RNG::NORMAL, 0.0, kColorNoise);
  cv::add(blurred, noise, sum, cv::noArray(), CV_8U);
  return sum;
}

/// Every second pixel of `depth` (metres) in whole millimetres, with axial noise.
cv::Mat noisyDepth(const cv::Mat& depth, cv::RNG& rng) {
  cv::Mat noisy(depth.size() / 2, CV_16UC1);
  for (int v = 0; v < noisy.rows; ++v)
    for (int u = 0; u < noisy.cols; ++u) {
      const double z = depth.at<float>(2 * v, 2 * u);
      noisy.at<std::uint16_t>(v, u) =
          cv::saturate_cast<std::uint16_t>(1000.0 * (z + (z > 0 ? rng.gaussian(depthSigma(z)) : 0.0)));
    }
  return noisy;
}

}  // namespace

ModelFeatures placeOnSurface(const ImageFeatures& features, cv::Size image, const TexturedMesh& mesh) {
  const cv::Mat triangles = triangleMap(mesh, image);
  ModelFeatures placed;
  for (int i = 0; i < features.count(); ++i) {
    const Keypoint& keypoint = features.keypoints[i];
    const cv::Point pixel(cvRound(keypoint.x), cvRound(keypoint.y));
    if (!cv::Rect({}, image).contains(pixel) || triangles.at<int>(pixel) < 0) continue;
    const auto corners = cornersOf(mesh, static_cast<size_t>(triangles.at<int>(pixel)), image);
    if (place(corners, keypoint, placed)) placed.descriptors.push_back(features.descriptors.row(i));
  }
  return placed;
}

PrintedObject makePrintedObject(int number, const FeatureExtractor& extractor, DescriptorType type) {
  cv::RNG rng(static_cast<std::uint64_t>(number) * 7919 + 17);
  const cv::Mat texture = makePrintTexture(kTextureSize, rng);
  // About in the proportions of the texture, whose print would look stretched on others.
  const double size = rng.uniform(0.08, 0.16);
  const auto stretched = [&] { return size * rng.uniform(0.9, 1.1); };
  const double x = stretched(), y = stretched(), z = stretched();
  const TexturedMesh mesh =
      number % 3 == 2 ? makeCylinder(0.36 * x, 1.1 * z, texture) : makeBox(Eigen::Vector3d(x, y, z), texture);
  auto model = std::make_shared<ObjectModel>();
  model->name = "printed_" + std::to_string(number);
  model->source = "benchmark";
  model->cloud = sampleSurface(mesh);
  model->extents = computeExtents(model->cloud);
  for (const double scale : {1.0, 0.5}) {
    cv::Mat gray, resized;
    cv::resize(toGray(texture, ColorOrder::kBgr), resized, {}, scale, scale, cv::INTER_AREA);
    cv::GaussianBlur(resized, gray, {}, kColorBlur);
    append(model->features[type], placeOnSurface(extractor.extract(gray, {}), gray.size(), mesh));
  }
  return {std::make_shared<TexturedMesh>(mesh), model};
}

PrintedScene makePrintedScene(const std::vector<std::shared_ptr<const TexturedMesh>>& meshes, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  cv::RNG rng(static_cast<std::uint64_t>(seed) + 1);
  PrintedScene scene;
  std::vector<MeshInstance> instances;
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(meshes.size()))));
  for (size_t i = 0; i < meshes.size(); ++i) {
    const double column = static_cast<double>(i % columns) - 0.5 * (columns - 1);
    const double row = static_cast<double>(i / columns) - 0.5 * (columns - 1);
    Pose pose = Pose::Identity();
    pose.linear() = randomRotation(random);
    pose.translation() = Eigen::Vector3d(0.3 * column, 0.25 * row, rng.uniform(0.8, 1.3));
    scene.camera_from_object.push_back(pose);
    instances.push_back({meshes[i], pose});
  }
  Pose wall = Pose::Identity();
  wall.linear() = Eigen::AngleAxisd(std::acos(-1.0), Eigen::Vector3d::UnitX()).toRotationMatrix();
  wall.translation() = Eigen::Vector3d(0.0, 0.0, 1.7);
  instances.push_back({makeWall(rng), wall});

  scene.frame.color_camera = {1280, 960, 1050.0, 1050.0, 639.5, 479.5};
  const RenderedView view = MeshRenderer(instances).render(scene.frame.color_camera, 1);
  scene.regions = (view.instance >= 0) & (view.instance < static_cast<int>(meshes.size()));
  scene.frame.color = noisyColor(view.color, rng);
  scene.frame.depth = noisyDepth(view.depth, rng);
  return scene;
}

}  // namespace recognition::benchmarks
