#include "ros/frame_pacer.h"

#include <iterator>

namespace recognition {
namespace {

constexpr size_t kMaxUnanswered = 100;  // while nobody answers

}  // namespace

bool FramePacer::admit(const ros::Time& stamp, const ros::WallTime& now) {
  if (!unanswered_.empty() && stamp < *unanswered_.rbegin()) forget();  // a recording that begins again
  if (!heard_.isZero() && now - heard_ > patience_) {
    inside_.clear();
    heard_ = ros::WallTime();
  }
  if (!heard_.isZero() && inside_.size() >= limit_) return false;
  if (!heard_.isZero()) inside_.insert(stamp);
  unanswered_.insert(stamp);
  if (unanswered_.size() > kMaxUnanswered) unanswered_.erase(unanswered_.begin());
  return true;
}

void FramePacer::withdraw(const ros::Time& stamp) {
  inside_.erase(stamp);
  unanswered_.erase(stamp);
}

void FramePacer::finished(const ros::Time& stamp, const ros::WallTime& now) {
  heard_ = now;
  // Stages keep the order: older ones were dropped on the way.
  inside_.erase(inside_.begin(), inside_.upper_bound(stamp));
  unanswered_.erase(stamp);
  const auto newer = unanswered_.upper_bound(stamp);
  lost_ += static_cast<std::uint64_t>(std::distance(unanswered_.begin(), newer));
  unanswered_.erase(unanswered_.begin(), newer);
}

void FramePacer::forget() {
  if (!heard_.isZero()) lost_ += unanswered_.size();
  inside_.clear();
  unanswered_.clear();
}

void FramePacer::reset() {
  inside_.clear();
  unanswered_.clear();
  heard_ = ros::WallTime();
}

}  // namespace recognition
