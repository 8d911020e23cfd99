#pragma once

#include <opencv2/core.hpp>

#include <atomic>
#include <memory>

#include "openni2/driver_stream.h"
#include "openni2/freenect_thread.h"
#include "openni2/kinect_clock.h"

namespace recognition::openni2 {

class FreenectStream;

/// A Microsoft Kinect through libfreenect. Its streams' frames come on the FreenectThread.
class FreenectDevice : public oni::driver::DeviceBase {
 public:
  /// Throws std::runtime_error that says why the device does not open (permission denied, busy, ...).
  FreenectDevice(FreenectThread* thread, const FreenectAddress& address);
  ~FreenectDevice() override;

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override { return sensors_.get(sensors, count); }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override;
  void destroyStream(oni::driver::StreamBase* stream) override;
  OniStatus getProperty(int id, void* data, int* size) override;
  OniStatus setProperty(int id, const void* data, int size) override;
  OniBool isPropertySupported(int id) override;
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode) override { return TRUE; }

  const FreenectAddress& address() const { return address_; }

  bool start(FreenectStream* stream);
  void stop(FreenectStream* stream);
  bool setFlag(freenect_flag flag, bool on);

 private:
  bool startDepth(FreenectStream* stream);
  bool startVideo(FreenectStream* stream);
  void stopNow(FreenectStream* stream);
  void depthArrived(const void* pixels, uint32_t ticks);
  void videoArrived(const void* pixels, uint32_t ticks);

  FreenectThread& thread_;
  const FreenectAddress address_;
  SensorList sensors_;

  // What follows belongs to the thread.
  freenect_device* device_ = nullptr;
  FreenectStream* depth_ = nullptr;  ///< while it runs
  FreenectStream* video_ = nullptr;  ///< colour or infrared, while it runs
  freenect_depth_format depth_format_ = FREENECT_DEPTH_MM;
  bool registered_ = false;
  KinectClock clock_;
};

class FreenectStream : public DriverStream {
 public:
  FreenectStream(FreenectDevice* device, OniSensorType sensor, FieldOfView field_of_view,
                 std::vector<OniVideoMode> modes)
      : DriverStream(sensor, field_of_view, std::move(modes)), device_(*device) {}

  OniStatus start() override { return device_.start(this) ? ONI_STATUS_OK : ONI_STATUS_OUT_OF_FLOW; }
  void stop() override { device_.stop(this); }
  /// Hands a frame with these pixels to OpenNI2; the first rows of them when there are more than the mode has.
  void send(const void* pixels, int64_t microseconds);

 protected:
  bool changeMode(const OniVideoMode&) override { return !running_; }
  bool changeAutoExposure(bool on) override { return device_.setFlag(FREENECT_AUTO_EXPOSURE, on); }
  bool changeAutoWhiteBalance(bool on) override { return device_.setFlag(FREENECT_AUTO_WHITE_BALANCE, on); }

 private:
  friend class FreenectDevice;
  FreenectDevice& device_;
  std::atomic<bool> running_{false};
};

}  // namespace recognition::openni2
