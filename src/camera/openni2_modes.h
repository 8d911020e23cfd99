#pragma once

#include <string>
#include <vector>

namespace recognition {

/// Size and rate of a camera's stream. Written as <size>_<rate>Hz: SXGA_30Hz (1280x1024), VGA_30Hz (640x480), QVGA_15Hz
/// (320x240).
struct StreamMode {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  int rate = 0;    ///< Hz
};

inline bool operator==(const StreamMode& a, const StreamMode& b) {
  return a.width == b.width && a.height == b.height && a.rate == b.rate;
}

/// Throws std::invalid_argument that names the text and the form wanted.
StreamMode parseStreamMode(const std::string& name);

/// The name; a size without one is written as 1024x768_30Hz, which parses, too.
std::string streamModeName(const StreamMode& mode);

/// The mode to take of those a device has: the same size at the nearest rate. Throws std::invalid_argument that lists
/// the device's modes when it has not got the size.
StreamMode closestStreamMode(const StreamMode& wanted, const std::vector<StreamMode>& available);

}  // namespace recognition
