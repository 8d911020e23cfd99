#pragma once

#include <cstddef>
#include <map>

#include <ros/time.h>

namespace recognition {

/// Time that a frame may take through all stages, for the last of them, which turns what is left into a budget of work.
/// All times in seconds.
class FrameBudget {
 public:
  /// 0: no limit.
  explicit FrameBudget(double seconds = 0.0) : limit_(seconds) {}

  /// An earlier stage took so long for the frame of that stamp, and is done with it now.
  void spentEarlier(const ros::Time& stamp, double seconds, const ros::WallTime& now);
  /// From here on the frame of that stamp is meant.
  void begin(const ros::Time& stamp, const ros::WallTime& now);

  bool isLimited() const { return limit_ > 0.0; }
  double spent(const ros::WallTime& now) const;
  bool exceeded(const ros::WallTime& now) const { return limit_ > 0.0 && spent(now) > limit_; }

  /// The time that is left as work for FrameSearch, by how fast this computer did its work until now: milliseconds of
  /// one core of 2.5 GHz; 0: no limit. A little always: the best hypotheses are the frame's objects.
  double workLeft(const ros::WallTime& now) const;
  /// What a search spent.
  void measured(double work_ms, double seconds);

 private:
  struct Earlier {
    double seconds = 0.0;
    ros::WallTime done;
  };

  double limit_;
  double speed_ = 0.0;  // milliseconds of work a second, smoothed; 0: not known
  std::map<ros::Time, Earlier> earlier_;
  double before_ = 0.0;  // spent on the present frame until began_
  ros::WallTime began_;
};

}  // namespace recognition
