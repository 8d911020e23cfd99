#include "camera/openni2_modes.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace recognition {
namespace {

struct NamedSize {
  const char* name;
  int width;
  int height;
};

constexpr NamedSize kSizes[] = {{"SXGA", 1280, 1024}, {"VGA", 640, 480}, {"QVGA", 320, 240}};

bool parseSize(const std::string& text, StreamMode* mode) {
  for (const NamedSize& size : kSizes) {
    if (text != size.name) continue;
    mode->width = size.width;
    mode->height = size.height;
    return true;
  }
  char rest = 0;
  return std::sscanf(text.c_str(), "%dx%d%c", &mode->width, &mode->height, &rest) == 2 && mode->width > 0 &&
         mode->height > 0;
}

}  // namespace

StreamMode parseStreamMode(const std::string& name) {
  StreamMode mode;
  const size_t separator = name.find('_');
  char unit[3] = {};
  char rest = 0;
  if (separator != std::string::npos && parseSize(name.substr(0, separator), &mode) &&
      std::sscanf(name.c_str() + separator, "_%d%2s%c", &mode.rate, unit, &rest) == 2 && std::string(unit) == "Hz" &&
      mode.rate > 0) {
    return mode;
  }
  throw std::invalid_argument("stream mode '" + name + "': not of the form VGA_30Hz (SXGA, VGA or QVGA)");
}

std::string streamModeName(const StreamMode& mode) {
  std::string size = std::to_string(mode.width) + "x" + std::to_string(mode.height);
  for (const NamedSize& named : kSizes) {
    if (named.width == mode.width && named.height == mode.height) size = named.name;
  }
  return size + "_" + std::to_string(mode.rate) + "Hz";
}

StreamMode closestStreamMode(const StreamMode& wanted, const std::vector<StreamMode>& available) {
  const StreamMode* closest = nullptr;
  std::string names;
  for (const StreamMode& mode : available) {
    names += " " + streamModeName(mode);
    if (mode.width != wanted.width || mode.height != wanted.height) continue;
    if (closest == nullptr || std::abs(mode.rate - wanted.rate) < std::abs(closest->rate - wanted.rate))
      closest = &mode;
  }
  if (closest != nullptr) return *closest;
  throw std::invalid_argument("the device has no " + streamModeName(wanted) + ", only" +
                              (names.empty() ? " none" : names));
}

}  // namespace recognition
