#pragma once

#include <map>
#include <string>

namespace recognition::openni2 {

/// A device on the virtual bus, as its plug file describes it.
struct VirtualPlug {
  std::string uri;
  std::string source;     ///< BOP recording, absolute path
  std::string serial;     ///< stays with the device when it is plugged in elsewhere
  std::string lock_file;  ///< whoever has the device open holds a lock on it; empty: nobody else can see the device
  bool access_denied = false;  ///< opening fails as it does when udev has not granted the device to the user
};

inline bool operator==(const VirtualPlug& a, const VirtualPlug& b) {
  return a.uri == b.uri && a.source == b.source && a.serial == b.serial && a.access_denied == b.access_denied;
}

/// The devices plugged in now, by URI.
///
/// The bus is a directory. A file <port>.kinect in it is a device plugged in at that port: write one to plug in,
/// remove it to unplug, write one under another name to plug in elsewhere. Its lines are `source: <folder>`, `serial:
/// <text>` (default: the port) and `access: denied`. A file without a source (being written) is not there yet.
std::map<std::string, VirtualPlug> readVirtualBus(const std::string& directory);

/// A device that is not on the bus: virtual:<folder of a recording>. Its URI and serial are this text.
/// Returns false when `uri` does not have that form.
bool parseVirtualUri(const std::string& uri, VirtualPlug* plug);

}  // namespace recognition::openni2
