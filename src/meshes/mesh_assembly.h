#pragma once

#include <string>

#include "meshes/raw_mesh.h"
#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {

/// What of a file's mesh is used: triangles, one texture (several, and plain colours beside textures, are packed into
/// one), or colours of vertices. `mesh_file` is where textures are looked for. Throws std::runtime_error with the
/// reason where a face has no colour that is right; see readMesh().
TexturedMesh assemble(RawMesh raw, double unit, const std::string& mesh_file, bool untextured);

}  // namespace recognition
