#pragma once

#include <cmath>
#include <cstdint>

namespace recognition::openni2 {

/// Time of a Microsoft Kinect: it stamps frames with a 32 bit counter of 60 MHz that starts anew every 71.6 s.
class KinectClock {
 public:
  /// Microseconds since the first stamp. Stamps of several streams may come in any order within half a turn of the
  /// counter.
  int64_t microseconds(uint32_t ticks) {
    if (!started_) {
      started_ = true;
      first_ = last_ = ticks;
    }
    last_ += static_cast<int32_t>(ticks - static_cast<uint32_t>(last_));
    return static_cast<int64_t>(last_ - first_) / kTicksPerMicrosecond;
  }

  /// Number of the frame with this stamp in a 30 Hz sequence: colour and depth of one moment have the same.
  static int frameIndex(int64_t microseconds) { return static_cast<int>(std::lround(microseconds * 30e-6)); }

 private:
  static constexpr int64_t kTicksPerMicrosecond = 60;

  bool started_ = false;
  int64_t first_ = 0;
  int64_t last_ = 0;
};

}  // namespace recognition::openni2
