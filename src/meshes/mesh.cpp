#include "rgbd_recognition/meshes/mesh.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

#include <Eigen/Geometry>

#include "core/short_number.h"
#include "meshes/mesh_assembly.h"
#include "meshes/mesh_readers.h"
#include "meshes/text_cursor.h"
#include "model/durable_file.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

constexpr double kMinExtent = 0.001;  // metres
constexpr double kMaxExtent = 5.0;
constexpr double kUsualMin = 0.02, kUsualMax = 1.5;
constexpr double kMaxDistance = 8.0;  // of a vertex from the origin; a store takes no points farther than 10 m

RawMesh readRaw(const std::string& file, const std::string& extension) {
  if (extension == ".ply") return readPly(readTextBytes(file));
  if (extension == ".obj") return readObj(readTextBytes(file), file);
  static const std::set<std::string> others = {".glb", ".gltf", ".dae", ".stl"};
  if (!others.count(extension)) throw std::runtime_error("is none of .ply, .obj, .glb, .gltf, .dae and .stl");
  return readThroughAssimp(file, extension);
}

Eigen::AlignedBox3f boxOf(const TexturedMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

// Which units would make a plausible length, for people.
std::string otherUnits(double length, double unit) {
  std::string text;
  for (const double other : {0.001, 0.01, 0.0254, 1.0}) {
    const double made = length / unit * other;
    if (other != unit && made >= kUsualMin && made <= kUsualMax)
      text += (text.empty() ? "" : ", ") + shortNumber(other) + " makes it " + shortNumber(made) + " m";
  }
  return text.empty() ? "" : " (" + text + ")";
}

void checkGeometry(const TexturedMesh& mesh, double unit) {
  if (mesh.triangles.empty()) throw std::runtime_error("has no faces");
  const Eigen::AlignedBox3f box = boxOf(mesh);
  const double extent = box.diagonal().maxCoeff();
  if (extent < kMinExtent || extent > kMaxExtent)
    throw std::runtime_error("is " + shortNumber(extent) + " m long, which is not plausible; is the unit right?" +
                             otherUnits(extent, unit));
  const double distance = box.center().norm() + 0.5 * box.diagonal().norm();
  if (distance > kMaxDistance)
    throw std::runtime_error("lies " + shortNumber(distance) +
                             " m away from its origin; move its origin into the object");
}

}  // namespace

std::string readBytes(const std::string& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) throw std::runtime_error(file + " cannot be read");
  std::string bytes(static_cast<size_t>(in.tellg()), '\0');
  in.seekg(0);
  if (!bytes.empty() && !in.read(&bytes[0], static_cast<std::streamsize>(bytes.size())))
    throw std::runtime_error(file + " cannot be read");
  return bytes;
}

std::string readTextBytes(const std::string& file) {
  std::string bytes = readBytes(file);
  if (bytes.compare(0, 3, "\xef\xbb\xbf") == 0) bytes.erase(0, 3);
  return bytes;
}

TexturedMesh readMesh(const std::string& file, double unit, bool untextured) {
  try {
    if (!fs::is_regular_file(file)) throw std::runtime_error("is no file");
    TexturedMesh mesh = assemble(readRaw(file, lowerCase(fs::path(file).extension().string())), unit, file, untextured);
    checkGeometry(mesh, unit);
    return mesh;
  } catch (const std::exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

double longestSide(const TexturedMesh& mesh) { return boxOf(mesh).diagonal().maxCoeff(); }

bool hasColors(const TexturedMesh& mesh) {
  if (!mesh.texture.empty()) return true;
  return std::any_of(mesh.vertex_colors.begin(), mesh.vertex_colors.end(),
                     [&](const cv::Vec3b& rgb) { return rgb != mesh.vertex_colors.front(); });
}

double texelSize(const TexturedMesh& mesh) {
  if (mesh.texture.empty()) return 0.0;
  double area = 0.0, texels = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector2f a = mesh.texture_coordinates[t[1]] - mesh.texture_coordinates[t[0]];
    const Eigen::Vector2f b = mesh.texture_coordinates[t[2]] - mesh.texture_coordinates[t[0]];
    area += (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm();
    texels += std::abs(a.x() * b.y() - a.y() * b.x()) * static_cast<double>(mesh.texture.total());
  }
  return texels > 0.0 ? std::sqrt(area / texels) : 0.0;
}

std::string meshChecksum(const TexturedMesh& mesh) {
  std::string bytes;
  const auto append = [&bytes](const auto& values) {
    if (!values.empty()) bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  append(mesh.vertices);
  append(mesh.normals);
  append(mesh.texture_coordinates);
  append(mesh.triangles);
  append(mesh.vertex_colors);
  const cv::Mat texture = mesh.texture.isContinuous() ? mesh.texture : mesh.texture.clone();
  if (!texture.empty()) bytes.append(texture.ptr<char>(), texture.total() * texture.elemSize());
  return checksum(bytes);
}

}  // namespace recognition
