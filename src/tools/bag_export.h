#pragma once

#include <string>

namespace recognition {

/// Writes a BOP split as a bag, without a ROS master: colour, camera info, depth, and on /tf the true pose of each
/// object (camera to obj_NNNNNN). `layout` "challenge": depth as an organised cloud; "openni": as a registered 16UC1
/// image. Frames are `interval` seconds apart. Throws std::runtime_error with file and reason.
void exportBag(const std::string& split_directory, const std::string& layout, const std::string& file,
               double interval = 0.5);

}  // namespace recognition
