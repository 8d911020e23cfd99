/// OpenNI2 driver of the Microsoft Kinect, over libfreenect.

#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>
#include <vector>

#include "openni2/driver_export.h"
#include "openni2/freenect_device.h"

namespace recognition::openni2 {
namespace {

OniDeviceInfo infoOf(const FreenectAddress& kinect) {
  OniDeviceInfo info = {};
  std::strncpy(info.uri, kinect.uri.c_str(), ONI_MAX_STR - 1);
  std::strncpy(info.vendor, "Microsoft", ONI_MAX_STR - 1);
  std::strncpy(info.name, "Kinect", ONI_MAX_STR - 1);
  info.usbVendorId = 0x045e;
  info.usbProductId = 0x02ae;
  return info;
}

bool contains(const std::vector<FreenectAddress>& kinects, const FreenectAddress& kinect) {
  return std::any_of(kinects.begin(), kinects.end(),
                     [&kinect](const FreenectAddress& other) { return other.uri == kinect.uri; });
}

}  // namespace

class FreenectDriver : public oni::driver::DriverBase {
 public:
  explicit FreenectDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    try {
      thread_ = std::make_unique<FreenectThread>([this] { rescan(); });
    } catch (const std::exception& error) {
      getServices().errorLoggerAppend("%s", error.what());
      return ONI_STATUS_ERROR;
    }
    thread_->call([this] { rescan(); });
    return ONI_STATUS_OK;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    FreenectAddress address;
    thread_->call([&] {
      for (const FreenectAddress& kinect : plugged_in_) {
        if (kinect.uri == uri) address = kinect;
      }
    });
    try {
      if (address.uri.empty()) throw std::runtime_error(std::string(uri) + ": not plugged in");
      auto device = std::make_unique<FreenectDevice>(thread_.get(), address);
      const std::lock_guard<std::mutex> lock(mutex_);
      open_.push_back(std::move(device));
      return open_.back().get();
    } catch (const std::exception& error) {
      getServices().errorLoggerAppend("%s", error.what());
      return nullptr;
    }
  }

  void deviceClose(oni::driver::DeviceBase* device) override {
    std::unique_ptr<FreenectDevice> closing;
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found =
        std::find_if(open_.begin(), open_.end(), [device](const auto& open) { return open.get() == device; });
    if (found == open_.end()) return;
    closing = std::move(*found);
    open_.erase(found);
  }

  /// OpenNI2 calls this with a lock that the thread needs while it tells of a device. A thread that waits for it is
  /// left to itself.
  void shutdown() override {
    open_.clear();
    if (thread_ && !thread_->stop()) thread_.release();
    thread_.reset();
  }

 private:
  /// On the thread. Opening a device to read its serial number disturbs its streams, so while all is well only their
  /// number is looked at.
  void rescan() {
    FreenectThread& thread = *thread_;
    const int count = freenect_num_devices(thread.context());
    if (count == static_cast<int>(plugged_in_.size()) && !thread.takeLoss()) return;
    const std::vector<FreenectAddress> now = listKinects(thread.context());
    const std::vector<FreenectAddress> before = plugged_in_;
    plugged_in_ = now;
    for (const FreenectAddress& kinect : before) {
      if (thread.stopping()) return;
      const OniDeviceInfo info = infoOf(kinect);
      if (!contains(now, kinect)) deviceDisconnected(&info);
    }
    for (const FreenectAddress& kinect : now) {
      if (thread.stopping()) return;
      const OniDeviceInfo info = infoOf(kinect);
      if (!contains(before, kinect)) deviceConnected(&info);
    }
  }

  std::unique_ptr<FreenectThread> thread_;
  std::vector<FreenectAddress> plugged_in_;  ///< the thread's own

  std::mutex mutex_;  ///< protects open_
  std::vector<std::unique_ptr<FreenectDevice>> open_;
};

}  // namespace recognition::openni2

ONI_EXPORT_DRIVER(recognition::openni2::FreenectDriver)
