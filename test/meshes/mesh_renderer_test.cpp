#include "meshes/mesh_renderer.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "meshes/sample_meshes.h"

namespace recognition {
namespace {

const CameraModel kCamera{160, 120, 200.0, 200.0, 79.5, 59.5};

Pose at(double x, double y, double z) { return Pose(Eigen::Translation3d(x, y, z)); }

std::shared_ptr<const TexturedMesh> grayBox(const Eigen::Vector3f& size) {
  return std::make_shared<TexturedMesh>(boxMesh(size, cv::Mat(64, 64, CV_8UC3, cv::Scalar(10, 20, 30))));
}

// Depth along the optical axis at which the ray of a pixel enters a box, 0 for none (slab method in the box's frame).
double boxDepth(const Pose& camera_from_box, const Eigen::Vector3d& half, const Eigen::Vector3d& direction) {
  const Pose box_from_camera = camera_from_box.inverse();
  const Eigen::Vector3d o = box_from_camera.translation();
  const Eigen::Vector3d d = box_from_camera.linear() * direction;
  double enter = 0.0, leave = 1e9;
  for (int k = 0; k < 3; ++k) {
    const double a = (-half[k] - o[k]) / d[k], b = (half[k] - o[k]) / d[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter < leave ? enter : 0.0;
}

TEST(MeshRenderer, DepthOfATurnedBoxIsThatOfItsPlanes) {
  const Pose pose = at(0.02, -0.01, 0.6) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 0.5).normalized());
  const RenderedView view = MeshRenderer({{grayBox({0.1f, 0.2f, 0.15f}), pose}}).render(kCamera);
  int differing = 0;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const double expected = boxDepth(pose, {0.05, 0.1, 0.075}, kCamera.unproject(u, v, 1.0));
      const double depth = view.depth.at<float>(v, u);
      if ((expected > 0.0) != (depth > 0.0))
        ++differing;
      else
        EXPECT_NEAR(depth, expected, 1e-5) << u << " " << v;
      EXPECT_EQ(view.instance.at<int>(v, u), depth > 0.0 ? 0 : -1);
    }
  }
  EXPECT_LE(differing, 2);  // rays through the very outline
  EXPECT_GT(cv::countNonZero(view.depth > 0), 1000);
}

TEST(MeshRenderer, NearerInstanceHidesTheOther) {
  const auto box = grayBox({0.1f, 0.1f, 0.1f});
  const RenderedView view = MeshRenderer({{box, at(0, 0, 1.0)}, {box, at(0, 0, 0.5)}}).render(kCamera);
  EXPECT_EQ(view.instance.at<int>(60, 80), 1);
  EXPECT_NEAR(view.depth.at<float>(60, 80), 0.45f, 1e-6f);
  EXPECT_EQ(view.color.at<cv::Vec3b>(60, 80), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(view.color.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 0));
  EXPECT_LT(
      (Eigen::Map<const Eigen::Vector3f>(view.normals.at<cv::Vec3f>(60, 80).val) - Eigen::Vector3f(0, 0, -1)).norm(),
      1e-6f);
}

TEST(MeshRenderer, MovingTheCameraIsMovingTheObject) {
  const auto box = std::make_shared<TexturedMesh>(boxMesh({0.1f, 0.2f, 0.15f}, blobTexture(512, 3)));
  const Pose pose = at(0.02, -0.01, 0.6) * Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 2, 0.5).normalized());
  const RenderedView moved_object = MeshRenderer({{box, pose}}).render(kCamera, 2);
  const RenderedView moved_camera = MeshRenderer({{box}}).render(kCamera, 2, pose);
  EXPECT_LT(cv::norm(moved_object.depth, moved_camera.depth, cv::NORM_L1) / kCamera.width / kCamera.height, 1e-4);
  EXPECT_LT(cv::norm(moved_object.color, moved_camera.color, cv::NORM_L1) / kCamera.width / kCamera.height, 0.5);
  EXPECT_LT(cv::norm(moved_object.normals, moved_camera.normals, cv::NORM_L1) / kCamera.width / kCamera.height, 1e-3);
}

// The lower left of the texture is at (0, 0): a face seen straight on shows the texture upright or mirrored as its
// coordinates say.
TEST(MeshRenderer, TextureOriginIsLowerLeft) {
  cv::Mat texture(64, 64, CV_8UC3, cv::Scalar(0, 0, 0));
  texture(cv::Rect(0, 32, 32, 32)).setTo(cv::Scalar(200, 0, 0));  // lower left quarter
  TexturedMesh square;
  square.texture = texture;
  square.vertices = {
      {-0.1f, 0.1f, 0.5f}, {0.1f, 0.1f, 0.5f}, {0.1f, -0.1f, 0.5f}, {-0.1f, -0.1f, 0.5f}};  // y down: lower left first
  square.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const RenderedView view = MeshRenderer({{std::make_shared<TexturedMesh>(square)}}).render(kCamera);
  EXPECT_EQ(view.color.at<cv::Vec3b>(80, 60), cv::Vec3b(200, 0, 0));
  EXPECT_EQ(view.color.at<cv::Vec3b>(40, 60), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(view.color.at<cv::Vec3b>(80, 100), cv::Vec3b(0, 0, 0));
}

TEST(MeshRenderer, FarTextureIsAveraged) {
  cv::Mat texture(256, 256, CV_8UC3);
  for (int v = 0; v < 256; ++v)
    for (int u = 0; u < 256; ++u) texture.at<cv::Vec3b>(v, u) = cv::Vec3b::all((u + v) % 2 ? 255 : 0);
  const auto box = std::make_shared<TexturedMesh>(boxMesh({0.1f, 0.1f, 0.1f}, texture));
  const RenderedView view = MeshRenderer({{box, at(0, 0, 2.0)}}).render(kCamera);
  EXPECT_NEAR(view.color.at<cv::Vec3b>(60, 80)[0], 127, 10);
}

TEST(MeshRenderer, VertexColoursWhereThereIsNoTexture) {
  TexturedMesh mesh = boxMesh({0.1f, 0.1f, 0.1f}, cv::Mat());
  mesh.texture_coordinates.clear();
  mesh.vertex_colors.assign(mesh.vertices.size(), cv::Vec3b(1, 2, 3));
  const RenderedView view = MeshRenderer({{std::make_shared<TexturedMesh>(mesh), at(0, 0, 0.5)}}).render(kCamera, 3);
  EXPECT_EQ(view.color.at<cv::Vec3b>(60, 80), cv::Vec3b(3, 2, 1));
}

TEST(MeshRenderer, SameForAnyNumberOfThreads) {
  const auto box = std::make_shared<TexturedMesh>(boxMesh({0.1f, 0.2f, 0.15f}, blobTexture(256, 3)));
  const MeshRenderer renderer({{box, at(0, 0, 0.5)}});
  cv::setNumThreads(1);
  const RenderedView one = renderer.render(kCamera, 2);
  for (const int threads : {2, 8}) {
    cv::setNumThreads(threads);
    const RenderedView many = renderer.render(kCamera, 2);
    EXPECT_EQ(cv::norm(one.color, many.color, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(one.depth, many.depth, cv::NORM_INF), 0.0);
  }
  cv::setNumThreads(-1);
}

TEST(MeshRenderer, RejectsBadArguments) {
  EXPECT_THROW(MeshRenderer({{nullptr}}), std::invalid_argument);
  const MeshRenderer empty({});
  EXPECT_THROW(empty.render(CameraModel()), std::invalid_argument);
  EXPECT_THROW(empty.render(kCamera, 0), std::invalid_argument);
  EXPECT_EQ(cv::countNonZero(empty.render(kCamera).depth), 0);
}

}  // namespace
}  // namespace recognition
