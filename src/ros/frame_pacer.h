#pragma once

#include <cstdint>
#include <set>

#include <ros/time.h>

namespace recognition {

/// Lets no more frames into the pipeline than it can finish, so that no stage works on what a later one would drop.
/// Without limit while nobody answers: the later stages do not run, or are gone. Keeps the books of what was let in.
class FramePacer {
 public:
  /// `limit`: frames in the pipeline at a time; `patience`: seconds after which a frame without an answer counts as
  /// lost.
  FramePacer(int limit, double patience) : limit_(static_cast<size_t>(limit)), patience_(patience) {}

  /// True if the frame may go on; it then is in the pipeline.
  bool admit(const ros::Time& stamp, const ros::WallTime& now);
  /// An admitted frame was bad and does not go on.
  void withdraw(const ros::Time& stamp);
  /// The last stage is done with the frame.
  void finished(const ros::Time& stamp, const ros::WallTime& now);
  /// Forgets all frames; the count of the lost ones stays.
  void reset();
  /// Frames that were admitted and that no answer can come for any more, as one for a newer frame came.
  std::uint64_t lost() const { return lost_; }

 private:
  void forget();

  size_t limit_;
  ros::WallDuration patience_;
  std::set<ros::Time> inside_;      // count for the limit
  std::set<ros::Time> unanswered_;  // these, and those that patience was lost with
  std::uint64_t lost_ = 0;
  ros::WallTime heard_;  // of the last stage; zero: not yet
};

}  // namespace recognition
