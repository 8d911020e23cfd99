#pragma once

#include <set>

#include <ros/time.h>

namespace rgbd_recognition {

/// Lets no more frames into the pipeline than it can finish, so that no stage works on what a later one would drop.
/// Without limit while nobody answers: the later stages do not run, or are gone.
class FramePacer {
 public:
  /// `limit`: frames in the pipeline at a time; `patience`: seconds after which a frame without an answer counts as
  /// lost.
  FramePacer(int limit, double patience) : limit_(static_cast<size_t>(limit)), patience_(patience) {}

  /// True if the frame may go on; it then is in the pipeline.
  bool admit(const ros::Time& stamp, const ros::WallTime& now);
  /// The last stage is done with the frame.
  void finished(const ros::Time& stamp, const ros::WallTime& now);
  void reset();

 private:
  size_t limit_;
  ros::WallDuration patience_;
  std::set<ros::Time> inside_;
  ros::WallTime heard_;  // of the last stage; zero: not yet
};

}  // namespace rgbd_recognition
