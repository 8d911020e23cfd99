#include "openni2/virtual_bus.h"

#include <filesystem>
#include <fstream>

namespace recognition::openni2 {
namespace {

namespace fs = std::filesystem;

constexpr char kScheme[] = "virtual:";
constexpr char kPlugExtension[] = ".kinect";

VirtualPlug readPlug(const fs::path& file) {
  VirtualPlug plug;
  plug.uri = kScheme + file.stem().string();
  plug.serial = file.stem().string();
  plug.lock_file = file.string();
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    const size_t colon = line.find(": ");
    if (colon == std::string::npos) continue;
    const std::string key = line.substr(0, colon);
    const std::string value = line.substr(colon + 2);
    if (key == "source") plug.source = value;
    if (key == "serial") plug.serial = value;
    if (key == "access") plug.access_denied = value == "denied";
  }
  return plug;
}

}  // namespace

std::map<std::string, VirtualPlug> readVirtualBus(const std::string& directory) {
  std::map<std::string, VirtualPlug> plugs;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    if (entry.path().extension() != kPlugExtension) continue;
    VirtualPlug plug = readPlug(entry.path());
    if (!plug.source.empty()) plugs[plug.uri] = plug;
  }
  return plugs;
}

bool parseVirtualUri(const std::string& uri, VirtualPlug* plug) {
  if (uri.rfind(std::string(kScheme) + "/", 0) != 0) return false;
  plug->uri = uri;
  plug->serial = uri;
  plug->source = uri.substr(sizeof(kScheme) - 1);
  return true;
}

}  // namespace recognition::openni2
