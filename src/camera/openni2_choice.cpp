#include "camera/openni2_choice.h"

#include <stdexcept>

namespace recognition {
namespace {

bool isListed(const std::vector<ListedDevice>& listed, const std::string& uri) {
  for (const ListedDevice& device : listed) {
    if (device.uri == uri) return true;
  }
  return false;
}

/// URIs of this kind are opened without being listed (a virtual device that plays the folder its URI names).
bool opensUnlisted(const std::string& uri) { return uri.find(":/") != std::string::npos; }

size_t parseIndex(const std::string& text) {
  const std::string digits = text.substr(1);
  if (digits.empty() || digits.size() > 3 || digits.find_first_not_of("0123456789") != std::string::npos ||
      std::stoul(digits) == 0) {
    throw std::invalid_argument("device_id '" + text + "': expected a number from 1 after '#'");
  }
  return std::stoul(digits) - 1;
}

}  // namespace

DeviceChoice::DeviceChoice(const std::string& text) : text_(text) {
  if (text.empty()) return;
  if (text[0] == '#') {
    index_ = parseIndex(text);
  } else if (text[0] == '/') {
    kind_ = Kind::kFile;
  } else if (text.find_first_of(":@") != std::string::npos) {
    kind_ = Kind::kUri;
  } else {
    kind_ = Kind::kSerial;
  }
}

std::string DeviceChoice::find(const std::vector<ListedDevice>& listed,
                               const std::function<std::string(const std::string&)>& serial_of) const {
  if (kind_ == Kind::kFile || (kind_ == Kind::kUri && opensUnlisted(text_))) return text_;
  if (kind_ == Kind::kUri && isListed(listed, text_)) return text_;
  const std::string serial = kind_ == Kind::kSerial ? text_ : remembered_serial_;
  if (!serial.empty()) {
    for (const ListedDevice& device : listed) {
      if (serial_of(device.uri) == serial) return device.uri;
    }
  }
  if (kind_ == Kind::kIndex && index_ < listed.size()) return listed[index_].uri;
  return "";
}

std::string DeviceChoice::description() const {
  switch (kind_) {
    case Kind::kUri:
      return "device " + text_;
    case Kind::kFile:
      return "file " + text_;
    case Kind::kSerial:
      return "device with serial number " + text_;
    default:
      return index_ == 0 ? "any device" : "device number " + std::to_string(index_ + 1);
  }
}

}  // namespace recognition
