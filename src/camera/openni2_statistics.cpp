#include "camera/openni2_statistics.h"

#include <algorithm>
#include <cmath>

namespace recognition {
namespace {

constexpr double kMaxGap = 10.0;  // seconds; a larger step is a clock that was set

}  // namespace

void StreamStatistics::restart(double now, double rate) {
  const std::lock_guard<std::mutex> lock(mutex_);
  report_ = Report();
  rate_ = rate;
  frames_at_report_ = 0;
  last_frame_ = last_report_ = now;
}

void StreamStatistics::count(uint64_t device_microseconds, double now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double gap = 1e-6 * (static_cast<double>(device_microseconds) - static_cast<double>(last_stamp_));
  if (report_.frames > 0 && gap > 0.0 && gap < kMaxGap) report_.dropped += std::max(0L, std::lround(gap * rate_) - 1);
  ++report_.frames;
  last_stamp_ = device_microseconds;
  last_frame_ = now;
}

StreamStatistics::Report StreamStatistics::report(double now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (now > last_report_) report_.rate = (report_.frames - frames_at_report_) / (now - last_report_);
  report_.silence = now - last_frame_;
  frames_at_report_ = report_.frames;
  last_report_ = now;
  return report_;
}

double StreamStatistics::silence(double now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return now - last_frame_;
}

}  // namespace recognition
