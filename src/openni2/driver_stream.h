#pragma once

#include <Driver/OniDriverAPI.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace recognition::openni2 {

/// Full angles, radians.
struct FieldOfView {
  float horizontal = 0.0f;
  float vertical = 0.0f;
};

/// FieldOfView of a width x height image with these focal lengths (pixels) and the principal point in the middle.
FieldOfView fieldOfView(int width, int height, double fx, double fy);

bool isSameMode(const OniVideoMode& a, const OniVideoMode& b);
OniVideoMode videoMode(OniPixelFormat format, int width, int height, int fps);

/// Swaps left and right of each row in place.
void mirrorRows(void* pixels, int width, int height, int bytes_per_pixel);

/// The part of a stream that is the same for all our devices: properties, frame headers, mirroring. Cropping is
/// answered ("off"), because the player of .oni files gives no frame of a stream that was recorded without it; it
/// cannot be switched on.
class DriverStream : public oni::driver::StreamBase {
 public:
  /// `modes` must not be empty; the first is the default.
  DriverStream(OniSensorType sensor, FieldOfView field_of_view, std::vector<OniVideoMode> modes);

  OniStatus getProperty(int id, void* data, int* size) override;
  OniStatus setProperty(int id, const void* data, int size) override;
  OniBool isPropertySupported(int id) override;
  void notifyAllProperties() override;

  OniSensorType sensor() const { return sensor_; }
  const OniVideoMode& mode() const { return mode_; }

 protected:
  /// Called with a listed mode before it is taken; false refuses it.
  virtual bool changeMode(const OniVideoMode&) { return true; }
  virtual bool changeAutoExposure(bool) { return true; }
  virtual bool changeAutoWhiteBalance(bool) { return true; }

  /// A frame of the present mode, everything filled in but its pixels; null when OpenNI2 is out of memory.
  OniFrame* newFrame(uint64_t timestamp_us, int index);
  /// Mirrors if wanted, hands the frame over, and gives back our reference.
  void deliver(OniFrame* frame);

 private:
  OniStatus setMode(const void* data, int size);
  OniStatus setSwitch(OniBool* value, bool (DriverStream::*change)(bool), const void* data, int size);

  const OniSensorType sensor_;
  const FieldOfView field_of_view_;
  const std::vector<OniVideoMode> modes_;
  OniVideoMode mode_;
  std::atomic<OniBool> mirrored_{FALSE};  // set by programs, read by the thread that delivers
  OniBool auto_exposure_ = TRUE;
  OniBool auto_white_balance_ = TRUE;
};

/// Sensor list in the form OpenNI2 wants it, owning what it points to.
class SensorList {
 public:
  void add(OniSensorType sensor, std::vector<OniVideoMode> modes);
  OniStatus get(OniSensorInfo** sensors, int* count);
  /// Modes of one sensor; empty when it is not there.
  std::vector<OniVideoMode> modes(OniSensorType sensor) const;

 private:
  std::vector<std::vector<OniVideoMode>> modes_;
  std::vector<OniSensorInfo> sensors_;
};

}  // namespace recognition::openni2
