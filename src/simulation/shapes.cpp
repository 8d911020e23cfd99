#include "simulation/shapes.h"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>

namespace recognition {
namespace {

void requirePositive(double value, const char* name) {
  if (!(value > 0.0) || !std::isfinite(value))
    throw std::invalid_argument(std::string("shape: ") + name + " is " + std::to_string(value));
}

std::uint32_t addVertex(TexturedMesh& mesh, const Eigen::Vector3d& position, const Eigen::Vector3d& normal, double u,
                        double v) {
  mesh.vertices.push_back(position.cast<float>());
  mesh.normals.push_back(normal.cast<float>());
  mesh.texture_coordinates.emplace_back(static_cast<float>(u), static_cast<float>(v));
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

// A rectangle about `centre` with half sides `right` and `up`, and the texture region (u0, v0)-(u1, v1).
void addRectangle(TexturedMesh& mesh, const Eigen::Vector3d& centre, const Eigen::Vector3d& right,
                  const Eigen::Vector3d& up, const cv::Rect2d& region) {
  const Eigen::Vector3d normal = right.cross(up).normalized();
  const double u1 = region.x + region.width;
  const double v1 = region.y + region.height;
  const std::uint32_t a = addVertex(mesh, centre - right - up, normal, region.x, region.y);
  const std::uint32_t b = addVertex(mesh, centre + right - up, normal, u1, region.y);
  const std::uint32_t c = addVertex(mesh, centre + right + up, normal, u1, v1);
  const std::uint32_t d = addVertex(mesh, centre - right + up, normal, region.x, v1);
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

void addLid(TexturedMesh& mesh, double radius, double z, int sides, double centre_u) {
  const Eigen::Vector3d normal(0.0, 0.0, z > 0 ? 1.0 : -1.0);
  const std::uint32_t middle = addVertex(mesh, {0, 0, z}, normal, centre_u, 0.12);
  for (int i = 0; i <= sides; ++i) {
    const double angle = 2 * CV_PI * i / sides;
    const Eigen::Vector3d rim(radius * std::cos(angle), radius * std::sin(angle), z);
    const std::uint32_t here =
        addVertex(mesh, rim, normal, centre_u + 0.11 * std::cos(angle), 0.12 + 0.11 * std::sin(angle));
    if (i > 0)
      mesh.triangles.push_back(z > 0 ? std::array<std::uint32_t, 3>{middle, here - 1, here}
                                     : std::array<std::uint32_t, 3>{middle, here, here - 1});
  }
}

// Rows of `columns` + 1 vertices that were added last become a closed band of triangles.
void addGrid(TexturedMesh& mesh, std::uint32_t first, int rows, int columns) {
  const auto stride = static_cast<std::uint32_t>(columns + 1);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const std::uint32_t a = first + static_cast<std::uint32_t>(r) * stride + static_cast<std::uint32_t>(c);
      mesh.triangles.push_back({a, a + 1, a + stride + 1});
      mesh.triangles.push_back({a, a + stride + 1, a + stride});
    }
}

}  // namespace

TexturedMesh makeBox(const Eigen::Vector3d& size, const cv::Mat& texture) {
  for (int k = 0; k < 3; ++k) requirePositive(size[k], "box side");
  TexturedMesh mesh;
  mesh.texture = texture;
  const Eigen::Vector3d x(size.x() / 2, 0, 0), y(0, size.y() / 2, 0), z(0, 0, size.z() / 2);
  const double cell = 1.0 / 3;
  addRectangle(mesh, x, y, z, {0, 0.5, cell, 0.5});
  addRectangle(mesh, -x, -y, z, {cell, 0.5, cell, 0.5});
  addRectangle(mesh, y, -x, z, {2 * cell, 0.5, cell, 0.5});
  addRectangle(mesh, -y, x, z, {0, 0, cell, 0.5});
  addRectangle(mesh, z, x, y, {cell, 0, cell, 0.5});
  addRectangle(mesh, -z, -x, y, {2 * cell, 0, cell, 0.5});
  return mesh;
}

TexturedMesh makeCylinder(double radius, double height, const cv::Mat& texture, int sides) {
  requirePositive(radius, "cylinder radius");
  requirePositive(height, "cylinder height");
  TexturedMesh mesh;
  mesh.texture = texture;
  for (const double z : {-height / 2, height / 2})
    for (int i = 0; i <= sides; ++i) {
      const double angle = 2 * CV_PI * i / sides;
      const Eigen::Vector3d normal(std::cos(angle), std::sin(angle), 0);
      addVertex(mesh, radius * normal + Eigen::Vector3d(0, 0, z), normal, static_cast<double>(i) / sides,
                z < 0 ? 0.25 : 1.0);
    }
  addGrid(mesh, 0, 1, sides);
  addLid(mesh, radius, height / 2, sides, 0.12);
  addLid(mesh, radius, -height / 2, sides, 0.88);
  return mesh;
}

TexturedMesh makeSphere(double radius, const cv::Mat& texture, int rings) {
  requirePositive(radius, "sphere radius");
  TexturedMesh mesh;
  mesh.texture = texture;
  for (int r = 0; r <= rings; ++r)
    for (int c = 0; c <= 2 * rings; ++c) {
      const double polar = CV_PI * (1.0 - static_cast<double>(r) / rings);
      const double angle = CV_PI * c / rings;
      const Eigen::Vector3d normal(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle),
                                   std::cos(polar));
      addVertex(mesh, radius * normal, normal, c / (2.0 * rings), static_cast<double>(r) / rings);
    }
  addGrid(mesh, 0, rings, 2 * rings);
  return mesh;
}

TexturedMesh makeTiledPlane(double width, double length, double tile, const cv::Mat& texture) {
  requirePositive(width, "plane width");
  requirePositive(length, "plane length");
  requirePositive(tile, "plane tile");
  TexturedMesh mesh;
  mesh.texture = texture;
  addRectangle(mesh, Eigen::Vector3d::Zero(), {width / 2, 0, 0}, {0, length / 2, 0},
               {0, 0, width / tile, length / tile});
  return mesh;
}

TexturedMesh makePrintedPlane(double width, double length, const cv::Mat& texture) {
  requirePositive(width, "plane width");
  requirePositive(length, "plane length");
  TexturedMesh mesh;
  mesh.texture = texture;
  addRectangle(mesh, Eigen::Vector3d::Zero(), {width / 2, 0, 0}, {0, length / 2, 0}, {0, 0, 1, 1});
  return mesh;
}

}  // namespace recognition
