#pragma once

#include <functional>
#include <string>
#include <vector>

namespace recognition {

/// A device that OpenNI2 lists.
struct ListedDevice {
  std::string uri;
  std::string name;
};

/// Which camera a user means. Texts: "" or "#1" the first that is there, "#2" the second, a URI (has a colon, or an at
/// sign as PrimeSense's 1d27/0609@2/5), an .oni file (its absolute path), or else a serial number.
class DeviceChoice {
 public:
  /// Throws std::invalid_argument that names the text when it is a "#" without a number from 1.
  explicit DeviceChoice(const std::string& text);

  /// URI to open now, empty when the device is not there. `serial_of` is asked for the serial numbers of listed
  /// devices, which may mean opening them, only when the choice needs it.
  ///
  /// Once remember() was called, the device with that serial number is looked for first, wherever it is plugged in now;
  /// a device chosen by its URI is taken from another port only if it is the same one.
  std::string find(const std::vector<ListedDevice>& listed,
                   const std::function<std::string(const std::string&)>& serial_of) const;

  /// The serial number of the device that was opened; "" has no effect.
  void remember(const std::string& serial) {
    if (!serial.empty()) remembered_serial_ = serial;
  }

  /// For messages: "the first device", "device with serial number A123", ...
  std::string description() const;

 private:
  enum class Kind { kIndex, kUri, kFile, kSerial };

  std::string text_;
  Kind kind_ = Kind::kIndex;
  size_t index_ = 0;
  std::string remembered_serial_;
};

}  // namespace recognition
