#include <array>
#include <stdexcept>

#include "meshes/mesh_readers.h"
#include "meshes/ply_header.h"
#include "meshes/ply_values.h"

namespace recognition {
namespace {

const std::vector<std::vector<std::string>> kPosition = {{"x"}, {"y"}, {"z"}};
const std::vector<std::vector<std::string>> kNormal = {{"nx", "normal_x"}, {"ny", "normal_y"}, {"nz", "normal_z"}};
const std::vector<std::vector<std::string>> kCoordinate = {
    {"texture_u", "u", "s", "texture_s", "texcoord_u", "tu", "u0", "s0", "u1", "s1"},
    {"texture_v", "v", "t", "texture_t", "texcoord_v", "tv", "v0", "t0", "v1", "t1"}};
const std::vector<std::vector<std::string>> kColor = {{"red", "diffuse_red", "r", "color_red", "vertex_red"},
                                                      {"green", "diffuse_green", "g", "color_green", "vertex_green"},
                                                      {"blue", "diffuse_blue", "b", "color_blue", "vertex_blue"}};

constexpr double kMaxIndex = 1e12;

/// Where the values of one kind stand among an element's properties; none if one of them is missing.
class Columns {
 public:
  Columns(const PlyElement& element, const std::vector<std::vector<std::string>>& names) {
    for (const auto& one : names) {
      const int column = element.find(one);
      if (column < 0 || element.properties[static_cast<size_t>(column)].is_list) {
        columns_.clear();
        return;
      }
      columns_.push_back(static_cast<size_t>(column));
    }
  }
  bool given() const { return !columns_.empty(); }
  double of(const PlyRow& row, size_t i) const { return row.scalars[columns_[i]]; }
  Eigen::Vector3d three(const PlyRow& row) const { return {of(row, 0), of(row, 1), of(row, 2)}; }
  const PlyType& type(const PlyElement& element) const { return element.properties[columns_[0]].value; }

 private:
  std::vector<size_t> columns_;
};

/// Colours of one element, in 8 bits once all of them are known.
class Colors {
 public:
  explicit Colors(const PlyElement& element) : columns_(element, kColor) {
    if (!columns_.given()) return;
    const PlyType& type = columns_.type(element);
    is_byte_ = type.size == 1;
    if (type.kind != PlyKind::kReal) scale_.see(255.0);  // 1 is nearly black there
  }
  void add(const PlyRow& row) {
    if (!columns_.given()) return;
    values_.emplace_back(columns_.of(row, 0), columns_.of(row, 1), columns_.of(row, 2));
    for (int k = 0; k < 3; ++k) {
      double& value = values_.back()[k];
      if (is_byte_ && value < 0.0) value += 256.0;  // declared as char
      scale_.see(value);
    }
  }
  std::vector<cv::Vec3b> inBytes() const {
    std::vector<cv::Vec3b> bytes;
    bytes.reserve(values_.size());
    for (const cv::Vec3d& value : values_) bytes.push_back(scale_.apply(value));
    return bytes;
  }

 private:
  Columns columns_;
  bool is_byte_ = false;
  std::vector<cv::Vec3d> values_;
  ColorScale scale_;
};

void readVertices(PlyValues& values, const PlyElement& element, RawMesh& mesh) {
  const Columns position(element, kPosition), normal(element, kNormal), coordinate(element, kCoordinate);
  if (!position.given()) throw std::runtime_error("its vertices have no x, y and z");
  Colors colors(element);
  for (PlyRow row(element); values.next(element, &row);) {
    mesh.positions.push_back(position.three(row));
    if (normal.given()) mesh.normals.push_back(normal.three(row).cast<float>());
    if (coordinate.given())
      mesh.coordinates.emplace_back(static_cast<float>(coordinate.of(row, 0)),
                                    static_cast<float>(coordinate.of(row, 1)));
    colors.add(row);
  }
  mesh.position_colors = colors.inBytes();
}

/// Faces, with what their corners have of their own.
class FaceReader {
 public:
  FaceReader(const PlyElement& element, RawMesh& mesh)
      : element_(element),
        mesh_(mesh),
        indices_(listNamed({"vertex_indices", "vertex_index", "vertex_indexes"})),
        coordinates_(listNamed({"texcoord", "texcoords", "texture_coordinates"})),
        texture_(element.find({"texnumber", "texture_number", "material_index"})),
        colors_(element) {
    if (indices_ < 0) throw std::runtime_error("its faces have no list vertex_indices");
  }

  void read(PlyValues& values) {
    for (PlyRow row(element_); values.next(element_, &row);) add(row);
    mesh_.face_colors = colors_.inBytes();
  }
  bool hasCoordinates() const { return coordinates_ >= 0; }

 private:
  int listNamed(const std::vector<std::string>& names) const {
    const int found = element_.find(names);
    return found >= 0 && element_.properties[static_cast<size_t>(found)].is_list ? found : -1;
  }

  void add(const PlyRow& row) {
    const std::vector<double>& indices = row.lists[static_cast<size_t>(indices_)];
    if (indices.empty()) throw std::runtime_error("has a face without corners");
    const RawFace face{mesh_.corners.size(), static_cast<std::uint32_t>(indices.size()), materialOf(row)};
    for (const double index : indices)
      mesh_.corners.push_back({index >= 0.0 && index < kMaxIndex ? static_cast<std::int64_t>(index) : -1, -1, -1});
    if (coordinates_ >= 0) addCoordinates(row.lists[static_cast<size_t>(coordinates_)], face);
    mesh_.faces.push_back(face);
    colors_.add(row);
  }

  int materialOf(const PlyRow& row) const {
    if (texture_ < 0 || element_.properties[static_cast<size_t>(texture_)].is_list)
      return mesh_.materials.empty() ? -1 : 0;
    const double number = row.scalars[static_cast<size_t>(texture_)];
    return number >= 0.0 && number < static_cast<double>(mesh_.materials.size()) ? static_cast<int>(number) : -1;
  }

  // A face may have none.
  void addCoordinates(const std::vector<double>& list, const RawFace& face) {
    if (list.empty()) return;
    if (list.size() != 2 * face.count)
      throw std::runtime_error("a face has " + std::to_string(face.count) + " corners and " +
                               std::to_string(list.size()) + " numbers of texture coordinates");
    for (size_t i = 0; i < face.count; ++i) {
      mesh_.corners[face.first + i].coordinate = static_cast<std::int64_t>(mesh_.coordinates.size());
      mesh_.coordinates.emplace_back(static_cast<float>(list[2 * i]), static_cast<float>(list[2 * i + 1]));
    }
  }

  const PlyElement& element_;
  RawMesh& mesh_;
  int indices_, coordinates_, texture_;
  Colors colors_;
};

}  // namespace

RawMesh readPly(const std::string& bytes) {
  const PlyHeader header = readPlyHeader(bytes);
  PlyValues values(header, bytes);
  RawMesh vertices, mesh;
  for (const std::string& texture : header.textures) mesh.materials.push_back({texture, texture, std::nullopt, {}});
  bool by_corner = false;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      readVertices(values, element, vertices);
    } else if (element.name == "face") {
      FaceReader faces(element, mesh);
      faces.read(values);
      by_corner = faces.hasCoordinates();
    } else {
      for (PlyRow row(element); values.next(element, &row);) continue;
    }
  }
  mesh.positions = std::move(vertices.positions);
  mesh.position_colors = std::move(vertices.position_colors);
  mesh.normals = std::move(vertices.normals);
  if (!by_corner) mesh.coordinates = std::move(vertices.coordinates);
  for (RawCorner& corner : mesh.corners) {
    if (!mesh.normals.empty()) corner.normal = corner.position;
    if (!by_corner && !mesh.coordinates.empty()) corner.coordinate = corner.position;
  }
  return mesh;
}

}  // namespace recognition
