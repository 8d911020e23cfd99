#include "tracking/pose_filter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/angles.h"

namespace recognition {
namespace {

constexpr double kMaxAveraged = 25.0;                        // measurements; older ones fade
constexpr double kRecent = 0.2;                              // weight of the last innovation in their recent mean
constexpr double kPositionGain = 0.7, kVelocityGain = 0.35;  // while it moves
constexpr double kMaxSpeed = 2.0, kMaxTurn = 2.0 * kPi;      // metres and radians a second
constexpr double kRestTime = 0.3;                            // seconds in which it must stay in place to stand
constexpr double kHoldTime = 0.1;                            // seconds in which unmeasured motion fades
constexpr double kMinStill = 0.0025, kMaxStill = 0.008;  // metres by which the recent mean may be off while it stands
constexpr double kMinTurnless = 1.2 * kDegree, kMaxTurnless = 4.0 * kDegree;
constexpr double kNoiseShare = 1.5;  // of a measurement's deviation, likewise
constexpr double kJump = 3.0;        // times that of a single measurement

double deviation(const Matrix6d& covariance, int first) {
  return std::sqrt(std::max(0.0, covariance.diagonal().segment<3>(first).sum() / 3.0));
}

}  // namespace

Vector6d poseDifference(const Pose& a, const Pose& b) {
  const Eigen::AngleAxisd turn(b.linear() * a.linear().transpose());
  Vector6d out;
  out << b.translation() - a.translation(), turn.angle() * turn.axis();
  return out;
}

Pose movedBy(const Vector6d& by, const Pose& pose) {
  Pose out = pose;
  const Eigen::Vector3d turn = by.tail<3>();
  const double angle = turn.norm();
  if (angle > 0.0)
    out.linear() =
        Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle) * pose.linear()).normalized().toRotationMatrix();
  out.translation() += by.head<3>();
  return out;
}

PoseFilter::PoseFilter(const Eigen::Vector3d& centre, const Pose& fixed_from_object, double stamp)
    : centre_(centre), pose_(fixed_from_object * Eigen::Translation3d(centre)), stamp_(stamp), anchor_(pose_) {}

Pose PoseFilter::objectFrom(const Pose& fixed_from_centre) const {
  return fixed_from_centre * Eigen::Translation3d(-centre_);
}

Pose PoseFilter::predicted(double stamp) const {
  if (!moves_) return pose();
  return objectFrom(movedBy((stamp - stamp_) * velocity_, pose_));
}

void PoseFilter::measure(double stamp, const Pose& fixed_from_object, const Matrix6d& noise) {
  const Pose measured = fixed_from_object * Eigen::Translation3d(centre_);
  const double seconds = stamp - stamp_;
  still_ = std::clamp(kNoiseShare * deviation(noise, 0), kMinStill, kMaxStill);
  turnless_ = std::clamp(kNoiseShare * deviation(noise, 3), kMinTurnless, kMaxTurnless);
  const Pose expected = moves_ ? movedBy(seconds * velocity_, pose_) : pose_;
  const Vector6d innovation = poseDifference(expected, measured);
  if (moves_) {
    pose_ = expected;
    follow(stamp, innovation, seconds);
  } else {
    average(stamp, innovation, measured);
  }
  stamp_ = stamp;
}

void PoseFilter::average(double stamp, const Vector6d& innovation, const Pose& measured) {
  drift_ = (1.0 - kRecent) * drift_ + kRecent * innovation;
  const bool drifts = drift_.head<3>().norm() > still_ || drift_.tail<3>().norm() > turnless_;
  const bool jumps = innovation.head<3>().norm() > kJump * still_ || innovation.tail<3>().norm() > kJump * turnless_;
  if (drifts || jumps) {
    moves_ = true;
    const double seconds = stamp - stamp_;
    velocity_ = seconds > 0.0 ? (0.5 / seconds * innovation).eval() : Vector6d::Zero().eval();
    anchor_ = pose_ = measured;
    anchor_stamp_ = stamp;
    return;
  }
  averaged_ = std::min(kMaxAveraged, averaged_ + 1.0);
  pose_ = movedBy(innovation / averaged_, pose_);
}

void PoseFilter::follow(double stamp, const Vector6d& innovation, double seconds) {
  pose_ = movedBy(kPositionGain * innovation, pose_);
  if (seconds > 0.0) velocity_ += kVelocityGain / seconds * innovation;
  const double speed = velocity_.head<3>().norm(), turn = velocity_.tail<3>().norm();
  if (speed > kMaxSpeed) velocity_.head<3>() *= kMaxSpeed / speed;
  if (turn > kMaxTurn) velocity_.tail<3>() *= kMaxTurn / turn;
  const Vector6d way = poseDifference(anchor_, pose_);
  if (way.head<3>().norm() > 2.0 * still_ || way.tail<3>().norm() > 2.0 * turnless_) {
    anchor_ = pose_;
    anchor_stamp_ = stamp;
  } else if (stamp - anchor_stamp_ >= kRestTime) {
    stand(stamp, pose_);
  }
}

void PoseFilter::stand(double stamp, const Pose& at) {
  moves_ = false;
  velocity_.setZero();
  drift_.setZero();
  averaged_ = 2.0;
  pose_ = at;
  stamp_ = stamp;
}

void PoseFilter::hold(double stamp) {
  const double seconds = std::max(0.0, stamp - stamp_);
  stamp_ = stamp;
  if (!moves_) return;
  const double way = kHoldTime * (1.0 - std::exp(-seconds / kHoldTime));  // seconds of the velocity, as it fades
  pose_ = movedBy(way * velocity_, pose_);
  velocity_ *= std::exp(-seconds / kHoldTime);
  anchor_ = pose_;
  anchor_stamp_ = stamp;
}

}  // namespace recognition
