#include "ros/frame_budget.h"

#include <algorithm>

namespace recognition {
namespace {

constexpr size_t kMin = 10;  // hypotheses tested however late it is: the best of them are the frame's objects
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

size_t FrameBudget::affordable(size_t hypotheses, const ros::WallTime& now) const {
  if (limit_ <= 0.0 || hypothesis_ <= 0.0) return hypotheses;
  const double left = std::max(0.0, limit_ - spent(now));
  return std::min(hypotheses, std::max(kMin, static_cast<size_t>(left / hypothesis_)));
}

void FrameBudget::tested(size_t hypotheses, double seconds) {
  if (hypotheses == 0) return;
  const double each = seconds / static_cast<double>(hypotheses);
  hypothesis_ = hypothesis_ > 0.0 ? (1.0 - kSmoothing) * hypothesis_ + kSmoothing * each : each;
}

}  // namespace recognition
