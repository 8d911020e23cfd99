#pragma once

#include <array>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "meshes/textured_surface.h"
#include "model/temporary_directory.h"
#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {

/// A box of 100 x 150 x 200 mm, in metres: its 8 corners, 6 sides of 4 corners seen from outside, a colour (BGR) a
/// side.
struct ColoredBox {
  std::array<std::array<double, 3>, 8> corners;
  std::array<std::array<int, 4>, 6> sides = {
      {{4, 6, 7, 5}, {2, 0, 1, 3}, {2, 3, 7, 6}, {1, 0, 4, 5}, {1, 5, 7, 3}, {4, 0, 2, 6}}};
  std::array<cv::Vec3b, 6> colors = {
      {{20, 20, 220}, {30, 200, 30}, {230, 40, 40}, {20, 220, 220}, {210, 30, 210}, {220, 220, 30}}};

  ColoredBox() {
    for (size_t i = 0; i < 8; ++i) corners[i] = {i & 4 ? 0.05 : -0.05, i & 2 ? 0.075 : -0.075, i & 1 ? 0.1 : -0.1};
  }

  /// Cells side by side, a side's colour each.
  cv::Mat texture(int first, int count) const {
    cv::Mat image(16, 16 * count, CV_8UC3);
    for (int i = 0; i < count; ++i) {
      const cv::Vec3b& c = colors[static_cast<size_t>(first + i)];
      image(cv::Rect(16 * i, 0, 16, 16)) = cv::Scalar(c[0], c[1], c[2]);
    }
    return image;
  }

  /// Texture coordinates of a side's corner k in cell i of `count`.
  static std::array<double, 2> coordinate(int i, int count, size_t k) {
    const double u = k == 1 || k == 2 ? 0.9 : 0.1, v = k >= 2 ? 0.9 : 0.1;
    return {(i + u) / count, v};
  }
};

/// Largest distance of a side's colour, in its middle, from what it is to be (a channel, 0 to 255).
inline double worstColor(const TexturedMesh& mesh, const ColoredBox& box) {
  const TexturedSurface surface(std::shared_ptr<const TexturedMesh>(std::shared_ptr<void>(), &mesh));
  double worst = mesh.triangles.empty() ? 255.0 : 0.0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    const Eigen::Vector3f middle =
        (mesh.vertices[triangle[0]] + mesh.vertices[triangle[1]] + mesh.vertices[triangle[2]]) / 3.0f;
    const Eigen::Vector3f share = middle.cwiseQuotient(Eigen::Vector3f(0.05f, 0.075f, 0.1f));
    int axis = 0;
    share.cwiseAbs().maxCoeff(&axis);
    const cv::Vec3b& wanted = box.colors[static_cast<size_t>(2 * axis + (share[axis] < 0.0f))];
    const Eigen::Vector3f bgr =
        surface.colorAt(static_cast<std::uint32_t>(t), Eigen::Vector3f::Constant(1.0f / 3.0f), 0.0f);
    for (int k = 0; k < 3; ++k) worst = std::max(worst, static_cast<double>(std::abs(bgr[k] - wanted[k])));
  }
  return worst;
}

}  // namespace recognition
