#pragma once

#include <string>

namespace recognition {

/// Whether a single frame's camera has distortion, which loadFrameFiles() undoes. Throws std::runtime_error as that does.
bool isDistorted(const std::string& color_file, const std::string& camera_file);

}  // namespace recognition
