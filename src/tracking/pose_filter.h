#pragma once

#include <Eigen/Core>

#include "rgbd_recognition/core/pose.h"

namespace recognition {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Pose of an object over time, turned about its centre: averaged while it stands still, so that it does not jitter;
/// followed with constant velocity while it moves. It moves once its measurements leave the average by more than their
/// noise, and stands once it stays in place for some tenths of a second.
class PoseFilter {
 public:
  /// `centre`: of the model, object frame.
  PoseFilter(const Eigen::Vector3d& centre, const Pose& fixed_from_object, double stamp);

  Pose predicted(double stamp) const;
  /// `noise` as Refinement::frame_noise.
  void measure(double stamp, const Pose& fixed_from_object, const Matrix6d& noise);
  /// Nothing was measured: what moves comes to rest.
  void hold(double stamp);

  Pose pose() const { return objectFrom(pose_); }
  bool moves() const { return moves_; }
  Vector6d velocity() const { return moves_ ? velocity_ : Vector6d::Zero().eval(); }

 private:
  Pose objectFrom(const Pose& fixed_from_centre) const;
  void stand(double stamp, const Pose& at);
  void average(double stamp, const Vector6d& innovation, const Pose& measured);
  void follow(double stamp, const Vector6d& innovation, double seconds);

  Eigen::Vector3d centre_;
  Pose pose_;  // fixed_from_centre
  double stamp_;
  Vector6d velocity_ = Vector6d::Zero();
  bool moves_ = false;
  double averaged_ = 1.0;                // measurements in pose_
  Vector6d drift_ = Vector6d::Zero();    // recent mean of the innovations
  double still_ = 0.0, turnless_ = 0.0;  // metres, radians: within which it stands, by the noise
  Pose anchor_;                          // where it was at anchor_stamp_, while it moves
  double anchor_stamp_ = 0.0;
};

/// b - a: shift of the origin, and the rotation vector that turns a into b, in the fixed frame's axes.
Vector6d poseDifference(const Pose& a, const Pose& b);
/// `pose` shifted, and turned about its origin.
Pose movedBy(const Vector6d& by, const Pose& pose);

}  // namespace recognition
