#pragma once

#include <optional>
#include <string>

#include <opencv2/core.hpp>

namespace recognition {

/// The file that a mesh names: at the path as it is written (from the mesh's folder, or absolute), else in the mesh's
/// folder by the last part of that path. Backslashes, "file://", quotes, %20 and another case of letters do not matter.
std::optional<std::string> findBeside(const std::string& mesh_file, const std::string& name);

/// A picture as CV_8UC3 BGR with its rows as they are stored (no EXIF rotation), reduced to 8192 pixels a side. Throws
/// std::runtime_error that names it: missing, or no image of the formats that are read.
cv::Mat readTextureFile(const std::string& mesh_file, const std::string& name);

/// The same from memory; `name` is for the message.
cv::Mat decodeTexture(const std::string& bytes, const std::string& name);

/// A TGA image (true colour, gray or palette; run-length encoded or not) as CV_8UC3 BGR; empty if it is none.
cv::Mat decodeTga(const std::string& bytes);

}  // namespace recognition
