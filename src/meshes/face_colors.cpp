#include "meshes/face_colors.h"

#include <algorithm>
#include <stdexcept>

namespace recognition {
namespace {

bool hasCoordinates(const RawMesh& mesh, const RawFace& face) {
  for (size_t i = face.first; i < face.first + face.count; ++i)
    if (mesh.corners[i].coordinate < 0) return false;
  return true;
}

ColorSource sourceOf(const RawMesh& mesh, size_t index) {
  const RawFace& face = mesh.faces[index];
  const RawMaterial* material = face.material >= 0 ? &mesh.materials[static_cast<size_t>(face.material)] : nullptr;
  const bool is_textured = material && material->hasTexture();
  if (is_textured && hasCoordinates(mesh, face)) return ColorSource::kTexture;
  if (!mesh.face_colors.empty()) return ColorSource::kFace;
  if (!mesh.position_colors.empty()) return ColorSource::kVertices;
  if (is_textured)
    throw std::runtime_error("face " + std::to_string(index) + " has the texture " + material->texture +
                             ", but no texture coordinates");
  return material && material->color ? ColorSource::kMaterial : ColorSource::kNone;
}

}  // namespace

std::vector<ColorSource> chooseColors(const RawMesh& mesh) {
  std::vector<ColorSource> sources;
  sources.reserve(mesh.faces.size());
  for (size_t i = 0; i < mesh.faces.size(); ++i) sources.push_back(sourceOf(mesh, i));
  const auto without = static_cast<size_t>(std::count(sources.begin(), sources.end(), ColorSource::kNone));
  if (without > 0 && without < sources.size())
    throw std::runtime_error(std::to_string(without) + " of its " + std::to_string(sources.size()) +
                             " faces have neither texture nor colour");
  return sources;
}

bool lacksTexture(const RawMesh& mesh, const std::vector<ColorSource>& sources) {
  if (mesh.coordinates.empty()) return false;
  const bool plain = std::all_of(sources.begin(), sources.end(), [](ColorSource source) {
    return source == ColorSource::kNone || source == ColorSource::kMaterial;
  });
  const bool single = std::all_of(mesh.faces.begin(), mesh.faces.end(),
                                  [&](const RawFace& face) { return face.material == mesh.faces.front().material; });
  return plain && single;
}

}  // namespace recognition
