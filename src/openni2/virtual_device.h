#pragma once

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "openni2/driver_stream.h"
#include "camera/openni2_intrinsics.h"
#include "openni2/virtual_bus.h"
#include "openni2/virtual_recording.h"

namespace recognition::openni2 {

class VirtualStream;

/// A Kinect that plays a recording, over and over, at 30 frames a second of its own clock. Colour and depth of one
/// frame have the same time stamp and index. A tick that comes late by a frame or more is skipped, as a real device
/// drops what nobody fetches.
class VirtualDevice : public oni::driver::DeviceBase {
 public:
  /// Throws std::runtime_error: access denied, device busy, or no recording there.
  explicit VirtualDevice(const VirtualPlug& plug);
  ~VirtualDevice() override;

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override { return sensors_.get(sensors, count); }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override;
  void destroyStream(oni::driver::StreamBase* stream) override;
  OniStatus getProperty(int id, void* data, int* size) override;
  OniStatus setProperty(int id, const void* data, int size) override;
  OniBool isPropertySupported(int id) override;
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode) override { return TRUE; }

  const VirtualPlug& plug() const { return plug_; }
  /// From now on no frame comes but one that is under way.
  void unplug();

  /// For its streams. Colour and infrared share a camera: false when the other one runs.
  bool start(VirtualStream* stream);
  /// No frame of the stream is under way any more when this returns.
  void stop(VirtualStream* stream);
  /// Forgets the stream's kept images; false while it runs, when its mode cannot be changed.
  bool prepareMode(const VirtualStream& stream);

 private:
  void run();
  /// Hands this tick's frames over, without `lock`: OpenNI2 calls this class with locks that taking a frame needs.
  void deliver(int tick, std::unique_lock<std::mutex>* lock);
  bool isRunning(const VirtualStream* stream) const;
  /// The recorded frame in the stream's mode. Kept (up to 100 a sensor), so that playing costs a copy only.
  cv::Mat image(const DriverStream& stream, int tick);

  const VirtualPlug plug_;
  int lock_ = -1;  ///< file descriptor that holds the lock on the plug file
  std::unique_ptr<VirtualRecording> recording_;
  SensorList sensors_;

  std::mutex mutex_;  ///< protects all below; never held while OpenNI2 is called
  std::condition_variable changed_;
  std::vector<VirtualStream*> running_;
  const VirtualStream* delivering_ = nullptr;  ///< its frame is under way, and it must live
  bool plugged_ = true;
  bool closing_ = false;
  bool registered_ = false;
  std::map<OniSensorType, std::map<int, cv::Mat>> images_;
  std::thread thread_;
};

class VirtualStream : public DriverStream {
 public:
  VirtualStream(VirtualDevice* device, OniSensorType sensor, const CameraModel& camera, std::vector<OniVideoMode> modes)
      : DriverStream(sensor, fieldOfView(camera.width, camera.width * 3 / 4, camera.fx, camera.fy), std::move(modes)),
        device_(*device),
        intrinsics_{camera.width, camera.fx, camera.fy, camera.cx, camera.cy} {}

  OniStatus getProperty(int id, void* data, int* size) override;
  OniBool isPropertySupported(int id) override {
    return id == kIntrinsicsProperty || DriverStream::isPropertySupported(id);
  }

  OniStatus start() override { return device_.start(this) ? ONI_STATUS_OK : ONI_STATUS_OUT_OF_FLOW; }
  void stop() override { device_.stop(this); }
  bool hasFrame(int tick) const;  ///< by the mode's rate
  void play(int tick, const cv::Mat& image);

 protected:
  bool changeMode(const OniVideoMode&) override { return device_.prepareMode(*this); }

 private:
  VirtualDevice& device_;
  const StreamIntrinsics intrinsics_;
};

}  // namespace recognition::openni2
