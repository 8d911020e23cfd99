#pragma once

namespace recognition {

/// A stream's property of our drivers, beyond those of OpenNI2, which knows a camera's fields of view only: the pinhole
/// camera of the stream's images at a width of `width` pixels.
struct StreamIntrinsics {
  int width = 0;
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
};

constexpr int kIntrinsicsProperty = 0x52474244;  // "RGBD", above ONI_STREAM_PROPERTY_PRIVATE_BASE

}  // namespace recognition
