#include "rgbd_recognition/tracking/tracker.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include <Eigen/Dense>

namespace recognition {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kDegree = 3.14159265358979323846 / 180.0;
// Frames of one view are not independent: each counts for this share of its evidence.
constexpr double kEvidence = 0.5;
constexpr double kMissEvidence = 0.3;
constexpr double kMaxLogit = 7.0;  // 0.999

double logit(double p) {
  const double bounded = std::clamp(p, 0.001, 0.999);
  return std::log(bounded / (1.0 - bounded));
}
double probability(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

Matrix6d diagonal(double translation, double rotation) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(translation * translation), Eigen::Vector3d::Constant(rotation * rotation);
  return variances.asDiagonal();
}

/// b - a: shift of the origin, and the rotation vector that turns a into b, in the fixed frame's axes.
Vector6d difference(const Pose& a, const Pose& b) {
  const Eigen::AngleAxisd turn(b.linear() * a.linear().transpose());
  Vector6d out;
  out << b.translation() - a.translation(), turn.angle() * turn.axis();
  return out;
}

void move(const Vector6d& by, Pose* pose) {
  const Eigen::Vector3d turn = by.tail<3>();
  const double angle = turn.norm();
  if (angle > 0.0)
    pose->linear() =
        Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle) * pose->linear()).normalized().toRotationMatrix();
  pose->translation() += by.head<3>();
}

}  // namespace

Tracker::Tracker(const TrackingParameters& parameters) : parameters_(parameters) { parameters_.validate(); }

TrackingOutcome Tracker::update(double stamp, const std::vector<TrackedDetection>& detections,
                                const Pose& fixed_from_camera) {
  TrackingOutcome outcome;
  if (started_ && stamp < stamp_) {
    outcome.restarted = true;
    followed_.clear();
  }
  if (!started_ || outcome.restarted) stamp_ = stamp;
  started_ = true;
  predict(stamp, fixed_from_camera);
  const std::vector<bool> taken = associate(stamp, detections, &outcome);
  for (size_t i = 0; i < detections.size(); ++i)
    if (!taken[i]) start(detections[i], stamp, &outcome);
  dropLost(&outcome);
  stamp_ = stamp;
  for (const Followed& f : followed_)
    if (f.track.confirmed) outcome.tracks.push_back(f.track);
  std::sort(outcome.tracks.begin(), outcome.tracks.end(), [](const Track& a, const Track& b) {
    return std::tie(a.object, a.instance) < std::tie(b.object, b.instance);
  });
  return outcome;
}

void Tracker::predict(double stamp, const Pose& fixed_from_camera) {
  const double seconds = stamp - stamp_;
  const Pose camera_from_fixed = fixed_from_camera.inverse();
  for (Followed& f : followed_) {
    f.track.covariance +=
        seconds * diagonal(parameters_.drift_translation, kDegree * parameters_.drift_rotation);
    f.absent += seconds;
    if (!inView(camera_from_fixed * f.track.fixed_from_object)) continue;
    f.missed += seconds;
  }
}

std::vector<bool> Tracker::associate(double stamp, const std::vector<TrackedDetection>& detections,
                                     TrackingOutcome* outcome) {
  struct Pair {
    double distance;
    size_t track, detection;
  };
  std::vector<Pair> pairs;
  for (size_t t = 0; t < followed_.size(); ++t) {
    for (size_t d = 0; d < detections.size(); ++d) {
      if (followed_[t].track.object != detections[d].object) continue;
      const double distance =
          translationDistance(followed_[t].track.fixed_from_object, detections[d].fixed_from_object);
      if (distance <= parameters_.max_distance) pairs.push_back({distance, t, d});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<bool> used(followed_.size(), false), taken(detections.size(), false);
  for (const Pair& pair : pairs) {
    if (used[pair.track] || taken[pair.detection]) continue;
    used[pair.track] = taken[pair.detection] = true;
    take(detections[pair.detection], stamp, &followed_[pair.track], outcome);
  }
  for (size_t t = 0; t < used.size(); ++t) {
    Followed& f = followed_[t];
    if (!used[t] && f.missed > 0.0) f.track.confidence = probability(logit(f.track.confidence) - kMissEvidence);
  }
  return taken;
}

void Tracker::take(const TrackedDetection& detection, double stamp, Followed* followed, TrackingOutcome* outcome) {
  Track& track = followed->track;
  const Matrix6d noise =
      detection.covariance + diagonal(parameters_.least_translation, kDegree * parameters_.least_rotation);
  followed->missed = followed->absent = 0.0;
  track.last_seen = stamp;
  ++track.detections;
  if (rotationDistance(track.fixed_from_object, detection.fixed_from_object) > kDegree * parameters_.max_angle) {
    if (++followed->contradictions < parameters_.confirm_frames) return;
    track.fixed_from_object = detection.fixed_from_object;
    track.covariance = noise;
  } else {
    const Matrix6d gain = track.covariance * (track.covariance + noise).inverse();
    move(gain * difference(track.fixed_from_object, detection.fixed_from_object), &track.fixed_from_object);
    track.covariance = (Matrix6d::Identity() - gain) * track.covariance;
    track.covariance = 0.5 * (track.covariance + track.covariance.transpose()).eval();
  }
  followed->contradictions = 0;
  const double sum = logit(track.confidence) + kEvidence * std::max(0.0, logit(detection.confidence));
  track.confidence = std::max(detection.confidence, probability(std::min(sum, kMaxLogit)));
  if (track.confirmed || track.detections < parameters_.confirm_frames) return;
  track.confirmed = true;
  outcome->found.push_back(track);
}

void Tracker::start(const TrackedDetection& detection, double stamp, TrackingOutcome* outcome) {
  Followed followed;
  Track& track = followed.track;
  track.object = detection.object;
  track.instance = freeInstance(detection.object);
  track.fixed_from_object = detection.fixed_from_object;
  track.covariance =
      detection.covariance + diagonal(parameters_.least_translation, kDegree * parameters_.least_rotation);
  track.confidence = detection.confidence;
  track.detections = 1;
  track.last_seen = stamp;
  track.confirmed = parameters_.confirm_frames <= 1;
  if (track.confirmed) outcome->found.push_back(track);
  followed_.push_back(std::move(followed));
}

void Tracker::dropLost(TrackingOutcome* outcome) {
  std::vector<Followed> kept;
  for (Followed& f : followed_) {
    const bool lost = f.missed > parameters_.lost_after || f.absent > parameters_.forget_after;
    if (!lost)
      kept.push_back(std::move(f));
    else if (f.track.confirmed)
      outcome->lost.push_back(std::move(f.track));
  }
  followed_ = std::move(kept);
}

bool Tracker::inView(const Pose& camera_from_object) const {
  const Eigen::Vector3d p = camera_from_object.translation();
  return p.z() > 0.0 && std::abs(p.x()) < p.z() * std::tan(0.5 * kDegree * parameters_.view_width) &&
         std::abs(p.y()) < p.z() * std::tan(0.5 * kDegree * parameters_.view_height);
}

int Tracker::freeInstance(const std::string& object) const {
  std::set<int> used;
  for (const Followed& f : followed_)
    if (f.track.object == object) used.insert(f.track.instance);
  int instance = 0;
  while (used.count(instance)) ++instance;
  return instance;
}

}  // namespace recognition
