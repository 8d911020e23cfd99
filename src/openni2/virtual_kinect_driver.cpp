/// OpenNI2 driver of Kinects that are not there: they play recordings (see virtual_bus.h for how they are plugged in
/// and out).

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "openni2/driver_export.h"
#include "openni2/virtual_device.h"

namespace recognition::openni2 {
namespace {

constexpr char kBusVariable[] = "VIRTUAL_KINECT_BUS";
constexpr std::chrono::milliseconds kScanPeriod(50);
constexpr std::chrono::milliseconds kPatience(500);

OniDeviceInfo infoOf(const VirtualPlug& plug) {
  OniDeviceInfo info = {};
  std::strncpy(info.uri, plug.uri.c_str(), ONI_MAX_STR - 1);
  std::strncpy(info.vendor, "rgbd_recognition", ONI_MAX_STR - 1);
  std::strncpy(info.name, "Virtual Kinect", ONI_MAX_STR - 1);
  return info;
}

}  // namespace

class VirtualKinectDriver : public oni::driver::DriverBase {
 public:
  explicit VirtualKinectDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    const char* bus = std::getenv(kBusVariable);
    if (bus == nullptr || *bus == '\0') return ONI_STATUS_OK;
    bus_ = bus;
    scan();
    std::thread([this, watch = watch_] {
      while (!watch->stopping) {
        scan();
        if (!watch->stopping) std::this_thread::sleep_for(kScanPeriod);
      }
      watch->ended.set_value();
    }).detach();
    watching_ = true;
    return ONI_STATUS_OK;
  }

  OniStatus tryDevice(const char* uri) override {
    VirtualPlug plug;
    if (!parseVirtualUri(uri, &plug)) return ONI_STATUS_ERROR;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      plugs_[plug.uri] = plug;
    }
    const OniDeviceInfo info = infoOf(plug);
    deviceConnected(&info);
    return ONI_STATUS_OK;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = plugs_.find(uri);
    if (found == plugs_.end()) {
      getServices().errorLoggerAppend("%s: not plugged in", uri);
      return nullptr;
    }
    try {
      open_.push_back(std::make_unique<VirtualDevice>(found->second));
      return open_.back().get();
    } catch (const std::exception& error) {
      getServices().errorLoggerAppend("%s", error.what());
      return nullptr;
    }
  }

  void deviceClose(oni::driver::DeviceBase* device) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto is_it = [device](const std::unique_ptr<VirtualDevice>& open) { return open.get() == device; };
    open_.erase(std::remove_if(open_.begin(), open_.end(), is_it), open_.end());
  }

  /// Colour and depth of one frame always have the same stamp and index: there is nothing to switch on.
  void* enableFrameSync(oni::driver::StreamBase**, int) override { return this; }
  void disableFrameSync(void*) override {}

  /// OpenNI2 calls this with a lock that the watcher needs while it tells of a device. So the wait has an end, and then
  /// the watcher, once it is let go on, must not touch this object any more. Its code stays, as the library is never
  /// unloaded (linked with nodelete).
  void shutdown() override {
    watch_->stopping = true;
    if (watching_) watch_->ended.get_future().wait_for(kPatience);
  }

 private:
  struct Watch {
    std::atomic<bool> stopping{false};
    std::promise<void> ended;
  };

  void scan() {
    const std::shared_ptr<Watch> watch = watch_;
    const std::map<std::string, VirtualPlug> before = on_bus_;
    const std::map<std::string, VirtualPlug> now = readVirtualBus(bus_);
    on_bus_ = now;
    for (const auto& [uri, plug] : before) {
      const auto found = now.find(uri);
      if (watch->stopping) return;
      if (found == now.end() || !(found->second == plug)) pullOut(plug);
    }
    for (const auto& [uri, plug] : now) {
      const auto found = before.find(uri);
      if (watch->stopping) return;
      if (found == before.end() || !(found->second == plug)) putIn(plug);
    }
  }

  void putIn(const VirtualPlug& plug) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      plugs_[plug.uri] = plug;
    }
    const OniDeviceInfo info = infoOf(plug);
    deviceConnected(&info);
  }

  void pullOut(const VirtualPlug& plug) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      plugs_.erase(plug.uri);
      for (const auto& device : open_) {
        if (device->plug().uri == plug.uri) device->unplug();
      }
    }
    const OniDeviceInfo info = infoOf(plug);
    deviceDisconnected(&info);
  }

  std::string bus_;
  std::map<std::string, VirtualPlug> on_bus_;  ///< at the last scan; the watcher's own
  const std::shared_ptr<Watch> watch_ = std::make_shared<Watch>();
  bool watching_ = false;

  std::mutex mutex_;  ///< protects what follows; never held while OpenNI2 is called back
  std::map<std::string, VirtualPlug> plugs_;
  std::vector<std::unique_ptr<VirtualDevice>> open_;
};

}  // namespace recognition::openni2

ONI_EXPORT_DRIVER(recognition::openni2::VirtualKinectDriver)
