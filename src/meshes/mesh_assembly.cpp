#include "meshes/mesh_assembly.h"

#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>
#include <unordered_map>

#include "meshes/face_colors.h"
#include "meshes/files_beside.h"
#include "meshes/smooth_normals.h"
#include "meshes/texture_atlas.h"
#include "meshes/triangulation.h"

namespace recognition {
namespace {

constexpr size_t kMaxColors = 4096;  // that are kept apart beside textures

void checkIndices(const RawMesh& mesh) {
  const auto isIn = [](std::int64_t index, size_t count) {
    return index == -1 || (index >= 0 && index < static_cast<std::int64_t>(count));
  };
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    for (size_t i = 0; i < mesh.faces[f].count; ++i) {
      const RawCorner& corner = mesh.corners[mesh.faces[f].first + i];
      if (corner.position < 0 || !isIn(corner.position, mesh.positions.size()) ||
          !isIn(corner.coordinate, mesh.coordinates.size()) || !isIn(corner.normal, mesh.normals.size()))
        throw std::runtime_error("face " + std::to_string(f) + " names a vertex that is not there");
    }
  for (const Eigen::Vector3d& position : mesh.positions)
    if (!position.allFinite()) throw std::runtime_error("has a vertex that is not a finite point");
  for (const Eigen::Vector2f& coordinate : mesh.coordinates)
    if (!coordinate.allFinite()) throw std::runtime_error("has a texture coordinate that is not finite");
}

/// The colour of a face that has no texture.
cv::Vec3b plainColor(const RawMesh& mesh, size_t face, ColorSource source) {
  const RawFace& f = mesh.faces[face];
  if (source == ColorSource::kFace) return mesh.face_colors[face];
  if (source == ColorSource::kMaterial) return *mesh.materials[static_cast<size_t>(f.material)].color;
  cv::Vec3d sum;
  for (size_t i = 0; i < f.count; ++i)
    sum += mesh.position_colors[static_cast<size_t>(mesh.corners[f.first + i].position)];
  sum *= 1.0 / f.count;
  return {cv::saturate_cast<uchar>(sum[0]), cv::saturate_cast<uchar>(sum[1]), cv::saturate_cast<uchar>(sum[2])};
}

/// The textures and plain colours of a textured mesh, by face; an atlas where one texture does not do.
class Skin {
 public:
  Skin(const RawMesh& mesh, const std::vector<ColorSource>& sources, const std::string& mesh_file)
      : mesh_(mesh), covers_(mesh.faces.size()) {
    std::vector<TextureAtlas::Page> pages;
    std::map<std::string, size_t> by_name;
    for (size_t f = 0; f < mesh.faces.size(); ++f) {
      if (sources[f] != ColorSource::kTexture) continue;
      const RawMaterial& material = mesh.materials[static_cast<size_t>(mesh.faces[f].material)];
      const auto [known, is_new] = by_name.emplace(material.texture, pages.size());
      if (is_new)
        pages.push_back({material.image.empty() ? readTextureFile(mesh_file, material.texture) : material.image,
                         coordinate(mesh.faces[f], 0), coordinate(mesh.faces[f], 0)});
      TextureAtlas::Page& page = pages[known->second];
      for (size_t i = 0; i < mesh.faces[f].count; ++i) {
        page.min = page.min.cwiseMin(coordinate(mesh.faces[f], i));
        page.max = page.max.cwiseMax(coordinate(mesh.faces[f], i));
      }
      covers_[f] = {true, known->second};
    }
    const std::vector<cv::Vec3b> colors = findColors(sources);
    if (pages.size() > 1 || !colors.empty()) atlas_.emplace(pages, colors);
    image_ = atlas_ ? atlas_->image() : pages.front().image;
  }

  const cv::Mat& image() const { return image_; }

  Eigen::Vector2f at(size_t face, size_t corner) const {
    if (!atlas_) return coordinate(mesh_.faces[face], corner);
    const auto& [is_textured, index] = covers_[face];
    return is_textured ? atlas_->onPage(index, coordinate(mesh_.faces[face], corner)) : atlas_->ofColor(index);
  }

 private:
  const Eigen::Vector2f& coordinate(const RawFace& face, size_t corner) const {
    return mesh_.coordinates[static_cast<size_t>(mesh_.corners[face.first + corner].coordinate)];
  }

  // The plain colours that differ; coarser ones if there are too many.
  std::vector<cv::Vec3b> findColors(const std::vector<ColorSource>& sources) {
    for (const int mask : {0xff, 0xf8}) {
      std::map<std::array<uchar, 3>, size_t> known;
      std::vector<cv::Vec3b> colors;
      for (size_t f = 0; f < sources.size(); ++f) {
        if (sources[f] == ColorSource::kTexture) continue;
        const cv::Vec3b rgb = plainColor(mesh_, f, sources[f]);
        const auto cut = [&](int k) { return static_cast<uchar>(rgb[k] & mask); };
        const auto [color, is_new] = known.emplace(std::array<uchar, 3>{cut(0), cut(1), cut(2)}, colors.size());
        if (is_new) colors.push_back(rgb);
        covers_[f] = {false, color->second};
      }
      if (colors.size() <= kMaxColors || mask != 0xff) return colors;
    }
    return {};
  }

  const RawMesh& mesh_;
  std::vector<std::pair<bool, size_t>> covers_;  // by face: whether it is a page, and which page or colour
  std::optional<TextureAtlas> atlas_;
  cv::Mat image_;
};

/// Vertices that are the same in all that they have are one.
class VertexList {
 public:
  std::uint32_t indexOf(std::int64_t position, std::int64_t normal, const Eigen::Vector2f& uv, const cv::Vec3b& rgb) {
    Key key{position, normal, 0,
            static_cast<std::uint64_t>(rgb[0]) << 16 | static_cast<std::uint64_t>(rgb[1]) << 8 | rgb[2]};
    std::memcpy(&key.uv, uv.data(), sizeof key.uv);
    const auto [known, is_new] = known_.emplace(key, static_cast<std::uint32_t>(known_.size()));
    is_new_ = is_new;
    return known->second;
  }
  bool isNew() const { return is_new_; }

 private:
  struct Key {
    std::int64_t position, normal;
    std::uint64_t uv, rgb;
    bool operator==(const Key& other) const { return std::memcmp(this, &other, sizeof other) == 0; }
  };
  struct Hash {
    size_t operator()(const Key& key) const {
      std::uint64_t hash = 0;
      for (const std::uint64_t part :
           {static_cast<std::uint64_t>(key.position), static_cast<std::uint64_t>(key.normal), key.uv, key.rgb})
        hash = (hash ^ part) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
      return static_cast<size_t>(hash);
    }
  };

  std::unordered_map<Key, std::uint32_t, Hash> known_;
  bool is_new_ = false;
};

class Assembly {
 public:
  Assembly(RawMesh& raw, double unit, const std::string& mesh_file, bool untextured)
      : raw_(raw), unit_(unit), sources_(chooseColors(raw)) {
    if (!untextured && lacksTexture(raw, sources_))
      throw std::runtime_error("has texture coordinates, but names no texture that they lie on");
    addMissingNormals(raw);
    bool is_textured = false;
    for (const ColorSource source : sources_) {
      is_textured |= source == ColorSource::kTexture;
      is_colored_ |= source != ColorSource::kTexture && source != ColorSource::kNone;
    }
    if (is_textured) skin_.emplace(raw, sources_, mesh_file);
  }

  TexturedMesh run() {
    mesh_.vertices.reserve(raw_.positions.size());
    if (skin_) mesh_.texture = skin_->image();
    for (size_t f = 0; f < raw_.faces.size(); ++f) addFace(f);
    return std::move(mesh_);
  }

 private:
  void addFace(size_t f) {
    const RawFace& face = raw_.faces[f];
    if (face.count < 3) return;  // points and lines
    indices_.clear();
    places_.clear();
    for (size_t i = 0; i < face.count; ++i) {
      indices_.push_back(vertex(f, i));
      places_.push_back(raw_.positions[static_cast<size_t>(raw_.corners[face.first + i].position)]);
    }
    if (face.count == 3)
      mesh_.triangles.push_back({indices_[0], indices_[1], indices_[2]});
    else
      for (const auto& t : triangulate(places_))
        mesh_.triangles.push_back({indices_[t[0]], indices_[t[1]], indices_[t[2]]});
  }

  std::uint32_t vertex(size_t f, size_t i) {
    const RawCorner& corner = raw_.corners[raw_.faces[f].first + i];
    const auto position = static_cast<size_t>(corner.position);
    const Eigen::Vector2f uv = skin_ ? skin_->at(f, i) : Eigen::Vector2f(0.0f, 0.0f);
    cv::Vec3b rgb;
    if (!skin_ && is_colored_)
      rgb = sources_[f] == ColorSource::kVertices ? raw_.position_colors[position] : plainColor(raw_, f, sources_[f]);
    const std::uint32_t index = vertices_.indexOf(corner.position, corner.normal, uv, rgb);
    if (!vertices_.isNew()) return index;
    mesh_.vertices.push_back((raw_.positions[position] * unit_).cast<float>());
    mesh_.normals.push_back(raw_.normals[static_cast<size_t>(corner.normal)].stableNormalized());
    if (skin_) mesh_.texture_coordinates.push_back(uv);
    if (!skin_ && is_colored_) mesh_.vertex_colors.push_back(rgb);
    return index;
  }

  RawMesh& raw_;
  const double unit_;
  std::vector<ColorSource> sources_;  // by face
  bool is_colored_ = false;           // there are plain colours
  std::optional<Skin> skin_;
  TexturedMesh mesh_;
  VertexList vertices_;
  std::vector<std::uint32_t> indices_;  // of one face
  std::vector<Eigen::Vector3d> places_;
};

}  // namespace

TexturedMesh assemble(RawMesh raw, double unit, const std::string& mesh_file, bool untextured) {
  if (raw.faces.empty()) throw std::runtime_error("has no faces");
  checkIndices(raw);
  return Assembly(raw, unit, mesh_file, untextured).run();
}

}  // namespace recognition
