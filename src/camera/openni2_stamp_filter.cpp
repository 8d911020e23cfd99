#include "camera/openni2_stamp_filter.h"

#include <algorithm>
#include <cmath>

namespace recognition {
namespace {

constexpr size_t kRecent = 8;  // frames of all streams that may be under way at once

}  // namespace

double StampFilter::stamp(uint64_t device_microseconds, double arrival) {
  const double device = 1e-6 * static_cast<double>(device_microseconds);
  if (!started_ || std::abs(arrival - offset_ - device) > kClockJump) {
    started_ = true;
    offset_ = arrival - device;
    last_device_ = device;
    recent_.clear();
  }
  for (const auto& [earlier, stamp] : recent_) {
    if (earlier == device_microseconds) return stamp;
  }
  update(device, arrival);
  recent_.emplace_back(device_microseconds, device + offset_);
  if (recent_.size() > kRecent) recent_.pop_front();
  return device + offset_;
}

void StampFilter::update(double device, double arrival) {
  offset_ += kMaxDrift * std::max(0.0, device - last_device_);
  last_device_ = std::max(last_device_, device);
  offset_ = std::min(offset_, arrival - device);
}

}  // namespace recognition
