#pragma once

#include <string>

namespace recognition {

/// Throws std::runtime_error that names the file unless all that the header of a PLY file declares is there. Without
/// that, Assimp looks for the end of the header for ever, takes memory for any length that stands in the file, and
/// writes past its faces where they are declared twice.
void checkPly(const std::string& file);

/// Throws std::runtime_error for a face of so many corners that Assimp would be busy with it for long.
void checkObj(const std::string& file);

}  // namespace recognition
