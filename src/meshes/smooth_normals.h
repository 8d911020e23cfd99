#pragma once

#include "meshes/raw_mesh.h"

namespace recognition {

/// Gives each corner that has no normal one: the mean of the faces about its position, as far as they are within 60
/// degrees of its own face. All positions of corners must be in range.
void addMissingNormals(RawMesh& mesh);

}  // namespace recognition
