#pragma once

#include <cstdint>
#include <mutex>

namespace recognition {

/// Counts a stream's frames. Any thread may call.
class StreamStatistics {
 public:
  struct Report {
    long frames = 0;       ///< since the stream started
    long dropped = 0;      ///< frames that the device's stamps leave room for and that did not come
    double rate = 0.0;     ///< Hz, since the report before
    double silence = 0.0;  ///< seconds since the last frame, or since the start
  };

  /// The stream starts (again) at `now` seconds, with `rate` frames a second (not 0).
  void restart(double now, double rate);
  /// A frame with this stamp of the device came at `now`.
  void count(uint64_t device_microseconds, double now);
  Report report(double now);
  double silence(double now) const;

 private:
  mutable std::mutex mutex_;
  double rate_ = 30.0;
  uint64_t last_stamp_ = 0;
  double last_frame_ = 0.0;
  double last_report_ = 0.0;
  long frames_at_report_ = 0;
  Report report_;
};

}  // namespace recognition
