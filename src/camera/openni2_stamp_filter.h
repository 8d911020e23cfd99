#pragma once

#include <cstdint>
#include <deque>
#include <utility>

namespace recognition {

/// Turns a camera's time stamps into the computer's time.
///
/// A frame arrives after a delay that is never below some minimum and often above it (USB, scheduling), so arrival
/// times jitter while the device's clock does not. The filter takes arrival - device time at its smallest as the offset
/// of the clocks. To follow clocks that drift apart, the offset rises slowly between arrivals and comes down to each
/// arrival that proves it too large. So stamps keep the device's spacing to within kMaxDrift, and are late by the
/// smallest delay only.
///
/// All streams of a device share one filter: equal device stamps give equal stamps.
class StampFilter {
 public:
  /// Clocks of crystals differ by less than 100 millionths.
  static constexpr double kMaxDrift = 1e-4;
  /// A device stamp that disagrees by more than this with its arrival means that a clock was set (device restarted,
  /// recording starts anew, ROS time jumped): the filter starts anew. Seconds.
  static constexpr double kClockJump = 1.0;

  /// Seconds in the computer's time at which the frame with this stamp of the device was taken (but for the smallest
  /// delay), given that it arrived at `arrival` seconds.
  double stamp(uint64_t device_microseconds, double arrival);

 private:
  void update(double device, double arrival);

  bool started_ = false;
  double offset_ = 0.0;                             ///< computer's time - device's time, seconds
  double last_device_ = 0.0;                        ///< seconds
  std::deque<std::pair<uint64_t, double>> recent_;  ///< device stamps and what they became
};

}  // namespace recognition
