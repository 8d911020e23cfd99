#pragma once

#include <cstdint>

#include <ros/time.h>
#include <std_msgs/Header.h>

namespace recognition {

/// Knows a message of one topic that came already. roscpp connects twice where publisher and subscriber come up at the
/// same moment, and then delivers everything twice. A recording that begins again is none: its messages come later.
class RepeatFilter {
 public:
  /// True if the last message had the same stamp and number, and came less than a tenth of a second before `now`.
  bool isRepeat(const std_msgs::Header& header, const ros::WallTime& now) {
    const bool repeat = !header.stamp.isZero() && header.stamp == stamp_ && header.seq == seq_ &&
                        (now - arrived_) < ros::WallDuration(0.1);
    if (!repeat) arrived_ = now;
    stamp_ = header.stamp;
    seq_ = header.seq;
    return repeat;
  }

 private:
  ros::Time stamp_;
  std::uint32_t seq_ = 0;
  ros::WallTime arrived_;
};

}  // namespace recognition
