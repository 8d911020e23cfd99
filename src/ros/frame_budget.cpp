#include "ros/frame_budget.h"

#include <algorithm>

namespace recognition {
namespace {

constexpr double kMinWork = 10.0;         // ms of work that is done however late it is
constexpr double kUnknownSpeed = 1000.0;  // ms of work a second, before anything is measured: one core of 2.5 GHz
constexpr size_t kMaxFrames = 8;
constexpr double kSmoothing = 0.2;

}  // namespace

void FrameBudget::spentEarlier(const ros::Time& stamp, double seconds, const ros::WallTime& now) {
  Earlier& earlier = earlier_[stamp];
  earlier.seconds += seconds;
  earlier.done = now;
  while (earlier_.size() > kMaxFrames)
    earlier_.erase(earlier_.begin()->first != stamp ? earlier_.begin() : std::prev(earlier_.end()));
}

void FrameBudget::begin(const ros::Time& stamp, const ros::WallTime& now) {
  const auto found = earlier_.find(stamp);
  before_ = found == earlier_.end() ? 0.0 : found->second.seconds;
  began_ = found == earlier_.end() ? now : found->second.done;
}

double FrameBudget::spent(const ros::WallTime& now) const { return before_ + (now - began_).toSec(); }

double FrameBudget::workLeft(const ros::WallTime& now) const {
  if (limit_ <= 0.0) return 0.0;
  const double left = std::max(0.0, limit_ - spent(now));
  return std::max(kMinWork, left * (speed_ > 0.0 ? speed_ : kUnknownSpeed));
}

void FrameBudget::measured(double work_ms, double seconds) {
  if (!(work_ms > 0.0) || !(seconds > 0.0)) return;
  const double speed = work_ms / seconds;
  speed_ = speed_ > 0.0 ? (1.0 - kSmoothing) * speed_ + kSmoothing * speed : speed;
}

}  // namespace recognition
