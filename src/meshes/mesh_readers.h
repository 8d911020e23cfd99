#pragma once

#include <string>

#include "meshes/raw_mesh.h"

namespace recognition {

/// Readers of mesh files. They throw std::runtime_error with the reason, without the file's name. Nothing of the file
/// is trusted but what it holds: lengths and counts are checked before memory is taken for them.

/// Per vertex or per corner texture coordinates, several textures (texnumber), colours of vertices and faces under
/// their usual names and in any type, any elements in any order.
RawMesh readPly(const std::string& bytes);

/// OBJ with the MTL files that it names, which are looked for beside `file`; colours behind the coordinates of
/// vertices.
RawMesh readObj(const std::string& bytes, const std::string& file);

/// The materials of an MTL file.
std::vector<RawMaterial> readMtl(const std::string& bytes);

/// GLB, glTF, DAE, STL through Assimp, by the format that `extension` (".glb") names only.
RawMesh readThroughAssimp(const std::string& file, const std::string& extension);

/// All bytes of a file; throws std::runtime_error that names it.
std::string readBytes(const std::string& file);

/// The same without the mark that some editors put in front of a text in UTF-8.
std::string readTextBytes(const std::string& file);

}  // namespace recognition
