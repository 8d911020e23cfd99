#include "rgbd_recognition/ros/frame_pacer.h"

namespace rgbd_recognition {

bool FramePacer::admit(const ros::Time& stamp, const ros::WallTime& now) {
  if (!heard_.isZero() && now - heard_ > patience_) reset();
  if (!inside_.empty() && stamp < *inside_.rbegin()) inside_.clear();  // a recording that begins again
  if (!heard_.isZero() && inside_.size() >= limit_) return false;
  if (!heard_.isZero()) inside_.insert(stamp);
  return true;
}

void FramePacer::finished(const ros::Time& stamp, const ros::WallTime& now) {
  heard_ = now;
  inside_.erase(inside_.begin(),
                inside_.upper_bound(stamp));  // stages keep the order: older ones were dropped on the way
}

void FramePacer::reset() {
  inside_.clear();
  heard_ = ros::WallTime();
}

}  // namespace rgbd_recognition
