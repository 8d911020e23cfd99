#pragma once

#include <vector>

#include "meshes/raw_mesh.h"

namespace recognition {

/// Where the colours of a face are from.
enum class ColorSource { kNone, kTexture, kFace, kVertices, kMaterial };

/// For each face. Throws std::runtime_error where a face can have no right colour: a texture without coordinates,
/// coordinates without a texture, some faces with colours and others without.
std::vector<ColorSource> chooseColors(const RawMesh& mesh);

/// Whether a mesh has texture coordinates that nothing is known to lie under.
bool lacksTexture(const RawMesh& mesh, const std::vector<ColorSource>& sources);

}  // namespace recognition
