#pragma once

#include <OpenNI.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "camera/openni2_choice.h"
#include "camera/openni2_frame_pool.h"
#include "camera/openni2_modes.h"
#include "camera/openni2_thread.h"

namespace recognition {

enum class Sensor { kColor, kDepth, kInfrared };
constexpr size_t kSensors = 3;
const char* sensorName(Sensor sensor);

/// A frame as it comes: the image lacks its header.
struct OpenNi2Frame {
  sensor_msgs::ImagePtr image;
  uint64_t device_microseconds = 0;
};

/// One stream of a device. All but the callback happens on the thread of the device's owner, which must be an
/// OpenNi2Thread.
class OpenNi2Stream {
 public:
  using Callback = std::function<void(const OpenNi2Frame&)>;

  /// The callback comes on a thread of the stream's. Throws std::runtime_error with OpenNI2's reason.
  OpenNi2Stream(openni::Device& device, Sensor sensor, Callback callback);
  ~OpenNi2Stream();

  /// Takes the nearest mode the device has and returns it; throws std::invalid_argument when it has none of that size,
  /// std::runtime_error when the device refuses. The stream must not run.
  StreamMode setMode(const StreamMode& wanted);
  const StreamMode& mode() const { return mode_; }
  /// The ideal camera of a 640x480 image: what the driver says it is, or what the field of view makes it.
  sensor_msgs::CameraInfo idealCamera();

  void setMirrored(bool on) { stream_.setMirroringEnabled(on); }
  /// False when the device cannot.
  bool setAutoExposure(bool on);
  bool setAutoWhiteBalance(bool on);

  bool running() const { return running_; }
  /// Throws std::runtime_error with OpenNI2's reason.
  void start();
  void stop();
  /// Frames are read, if the stream runs, between resume() and pause(); no callback is under way when pause() returns.
  void resume();
  void pause();

 private:
  void read();
  void pass(const openni::VideoFrameRef& frame);

  const Sensor sensor_;
  const Callback callback_;
  FramePool pool_;  ///< must outlive the stream
  openni::VideoStream stream_;
  StreamMode mode_;
  bool running_ = false;
  std::atomic<bool> reading_{false};
  OpenNi2Thread reader_;
};

/// An open device of OpenNI2, with the streams it has. OpenNI2 lets a process open a device twice, and then the
/// streams' settings are shared; this class does not.
class OpenNi2Device {
 public:
  /// Throws std::runtime_error with URI and OpenNI2's reason, or when another object has the device.
  OpenNi2Device(const std::string& uri, const std::function<void(Sensor, const OpenNi2Frame&)>& callback);
  ~OpenNi2Device();

  const std::string& uri() const { return uri_; }
  const std::string& name() const { return name_; }      ///< vendor and product
  const std::string& serial() const { return serial_; }  ///< may be empty

  /// Null when the device has no such sensor.
  OpenNi2Stream* stream(Sensor sensor) { return streams_[static_cast<size_t>(sensor)].get(); }

  /// Whether depth is registered to colour now; the device may be unable to.
  bool setRegistration(bool on);
  /// Lets exactly these sensors' streams run. With `sync`, colour and depth frames come in pairs while both run at one
  /// rate, if the device can. Throws std::runtime_error with the reason of the first stream that does not start; the
  /// others run.
  void run(const std::array<bool, kSensors>& wanted, bool sync);

 private:
  /// Whether OpenNI2 is to synchronise the streams that run.
  bool isPaired(bool sync) const;

  std::shared_ptr<void> claim_;
  openni::Device device_;
  std::string uri_;
  std::string name_;
  std::string serial_;
  bool paired_ = false;
  std::array<std::unique_ptr<OpenNi2Stream>, kSensors> streams_;
};

/// OpenNI2 for as long as the object lives: devices that are there, and news of those that come and go.
class OpenNi2Session : private openni::OpenNI::DeviceConnectedListener,
                       private openni::OpenNI::DeviceDisconnectedListener {
 public:
  /// `gone` is called with the URI of a device that was unplugged, `come` when one was plugged in, on any thread; they
  /// must not call OpenNI2. Throws std::runtime_error when OpenNI2 finds no drivers.
  OpenNi2Session(std::function<void()> come, std::function<void(const std::string&)> gone);
  ~OpenNi2Session() override;

  std::vector<ListedDevice> list() const;
  /// Opens the device for a moment; "" when it has none or does not open.
  static std::string serialOf(const std::string& uri);

 private:
  void onDeviceConnected(const openni::DeviceInfo*) override { come_(); }
  void onDeviceDisconnected(const openni::DeviceInfo* info) override { gone_(info->getUri()); }

  const std::function<void()> come_;
  const std::function<void(const std::string&)> gone_;
};

}  // namespace recognition
