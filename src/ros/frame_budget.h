#pragma once

#include <cstddef>
#include <map>

#include <ros/time.h>

namespace recognition {

/// Time that a frame may take through all stages, for the last of them, which can leave out work. All times in seconds.
class FrameBudget {
 public:
  /// 0: no limit.
  explicit FrameBudget(double seconds = 0.0) : limit_(seconds) {}

  /// An earlier stage took so long for the frame of that stamp, and is done with it now.
  void spentEarlier(const ros::Time& stamp, double seconds, const ros::WallTime& now);
  /// From here on the frame of that stamp is meant.
  void begin(const ros::Time& stamp, const ros::WallTime& now);

  double spent(const ros::WallTime& now) const;
  bool exceeded(const ros::WallTime& now) const { return limit_ > 0.0 && spent(now) > limit_; }

  /// How many of so many hypotheses there is time to test, by what they took until now; a few always.
  size_t affordable(size_t hypotheses, const ros::WallTime& now) const;
  void tested(size_t hypotheses, double seconds);

 private:
  struct Earlier {
    double seconds = 0.0;
    ros::WallTime done;
  };

  double limit_;
  double hypothesis_ = 0.0;  // seconds each, smoothed
  std::map<ros::Time, Earlier> earlier_;
  double before_ = 0.0;  // spent on the present frame until began_
  ros::WallTime began_;
};

}  // namespace recognition
