#include "tracking/object_tracker.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include <opencv2/core/utility.hpp>

#include "core/angles.h"
#include "tracking/explained_pixels.h"

namespace recognition {
namespace {

constexpr size_t kMaxWaiting = 4;       // results of detection
constexpr double kCameraHistory = 4.0;  // seconds of the camera's places
constexpr double kSamePlace = 0.008;    // metres and degrees by which a detection may differ without being compared
constexpr double kSameAngle = 5.0;
constexpr double kClearlyBetter = 1.05;  // of the gain, for a detection's pose to replace the track's
constexpr double kAwait = 2.0;           // seconds in which the search goes on where an unconfirmed track is
constexpr double kMaxOverlap = 0.5;      // of the smaller one's pixels

int overlap(const ImagePart& a, const ImagePart& b) {
  const cv::Rect common = a.box & b.box;
  if (common.empty()) return 0;
  return cv::countNonZero(a.mask(common - a.box.tl()) & b.mask(common - b.box.tl()));
}

}  // namespace

ObjectTracker::ObjectTracker(const TrackingParameters& parameters, const VerificationParameters& verification,
                             std::shared_ptr<const PreparedModels> models)
    : context_{parameters, verification, std::move(models)} {
  parameters.validate();
  verification.validate();
}

ObjectTracker::~ObjectTracker() = default;

void ObjectTracker::add(double stamp, std::vector<VerifiedHypothesis> detections) {
  if (waiting_.size() == kMaxWaiting) {
    waiting_.pop_front();
    ++dropped_;
  }
  waiting_.push_back({stamp, std::move(detections)});
}

TrackingOutcome ObjectTracker::follow(double stamp, const RgbdFrame& frame, const Pose& fixed_from_camera) {
  frame.validate();
  TrackingOutcome outcome;
  if (started_ && stamp < stamp_ - context_.tracking.clock_step)
    restart(&outcome);
  else
    outcome.ignored = started_ && stamp <= stamp_;
  std::vector<const FollowedObject*> confirmed;
  for (const auto& one : followed_)
    if (one->track.confirmed) confirmed.push_back(one.get());
  if (!outcome.ignored) {
    stamp_ = stamp;
    started_ = true;
    const FrameInTime now{stamp, frame, fixed_from_camera};
    camera_.push_back({stamp, fixed_from_camera});
    while (camera_.front().stamp < stamp - kCameraHistory) camera_.pop_front();
    followAll(now);
    for (const Result& result : waiting_) take(result, now);
    waiting_.clear();
    resolveOverlaps();
    explain(frame.depth.size());
  }
  collect(confirmed, &outcome);
  return outcome;
}

void ObjectTracker::restart(TrackingOutcome* outcome) {
  outcome->restarted = true;
  for (const auto& one : followed_) {
    one->track.end = TrackEnd::kClockSetBack;
    if (one->track.confirmed) ended_.push_back(one->track);
  }
  followed_.clear();
  waiting_.clear();
  camera_.clear();
}

void ObjectTracker::followAll(const FrameInTime& frame) {
  std::vector<Sight> sights(followed_.size());
  const cv::Range all(0, static_cast<int>(followed_.size()));
  cv::parallel_for_(
      all,
      [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i)
          sights[static_cast<size_t>(i)] = followed_[static_cast<size_t>(i)]->look(frame, context_);
      },
      all.size());
  for (size_t i = 0; i < sights.size(); ++i) followed_[i]->take(sights[i], frame.stamp, context_.tracking);
}

void ObjectTracker::take(const Result& result, const FrameInTime& frame) {
  const Pose fixed_from_camera = cameraAt(result.stamp);
  const std::vector<FollowedObject*> partner = partners(result, fixed_from_camera);
  for (size_t i = 0; i < result.detections.size(); ++i) {
    const VerifiedHypothesis& detection = result.detections[i];
    const Pose then = fixed_from_camera * detection.camera_from_object;
    if (partner[i])
      compare(detection, then, result.stamp, frame, partner[i]);
    else
      begin(detection, then, result.stamp, frame);
  }
}

/// The track that each detection is of, by where it was in that frame, the nearest first; null: a new object.
std::vector<FollowedObject*> ObjectTracker::partners(const Result& result, const Pose& fixed_from_camera) {
  struct Pair {
    double distance;
    size_t track, detection;
  };
  std::vector<Pair> pairs;
  for (size_t d = 0; d < result.detections.size(); ++d) {
    const int object = result.detections[d].hypothesis.object;
    const Eigen::Vector3d centre = context_.models->at(object).centre.cast<double>();
    const Eigen::Vector3d place = fixed_from_camera * (result.detections[d].camera_from_object * centre);
    for (size_t t = 0; t < followed_.size(); ++t) {
      if (followed_[t]->track.object_index != object) continue;
      const double distance = (followed_[t]->placeAt(result.stamp) * centre - place).norm();
      if (distance <= context_.tracking.max_distance) pairs.push_back({distance, t, d});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<FollowedObject*> partner(result.detections.size(), nullptr);
  std::set<size_t> taken;
  for (const Pair& pair : pairs)
    if (!partner[pair.detection] && taken.insert(pair.track).second)
      partner[pair.detection] = followed_[pair.track].get();
  return partner;
}

/// A detection of a track: agrees with it, or is tested against it in the present frame.
void ObjectTracker::compare(const VerifiedHypothesis& detection, const Pose& then, double stamp,
                            const FrameInTime& frame, FollowedObject* track) {
  const Pose track_then = track->placeAt(stamp);
  const double angle = rotationDistance(track_then, then), distance = translationDistance(track_then, then);
  const bool agrees = angle <= kDegree * context_.tracking.max_angle;
  if (agrees) track->confirm(detection, context_.tracking);
  if (angle <= kDegree * kSameAngle && distance <= kSamePlace) return;
  const Pose now = track->place() * track_then.inverse() * then;
  const Sight sight = FollowedObject(detection, context_.models->object(track->track.object_index),
                                     context_.models->at(track->track.object_index), now, frame.stamp)
                          .look(frame, context_, &now);
  if (sight.state != TrackState::kSeen) return;
  const bool doubtful = track->track.state == TrackState::kDoubtful;
  if (!doubtful && sight.evidence.gain <= kClearlyBetter * track->evidence.gain) return;
  if (!agrees) track->confirm(detection, context_.tracking);
  track->jumpTo(sight, frame.stamp, context_.tracking);
}

/// A new object: where it was, or where a moving track's motion since then would have put it, if the frame shows it.
void ObjectTracker::begin(const VerifiedHypothesis& detection, const Pose& then, double stamp,
                          const FrameInTime& frame) {
  std::vector<Pose> places = {then};
  for (const auto& one : followed_) {
    const Pose motion = one->place() * one->placeAt(stamp).inverse();
    if (one->track.state == TrackState::kSeen && translationDistance(motion * then, then) > kSamePlace)
      places.push_back(motion * then);
  }
  const int object = detection.hypothesis.object;
  auto best = std::make_unique<FollowedObject>(detection, context_.models->object(object), context_.models->at(object),
                                               then, stamp);
  Sight best_sight;
  for (const Pose& place : places) {
    Sight sight = best->look(frame, context_, &place);
    const bool better = best_sight.state != TrackState::kSeen || sight.evidence.gain > best_sight.evidence.gain;
    if (sight.state == TrackState::kSeen && better) best_sight = std::move(sight);
  }
  if (best_sight.state != TrackState::kSeen) {
    ++dropped_;
    return;
  }
  best->track.instance = freeInstance(best->track.object);
  best->track.confirmed =
      detection.confidence >= context_.tracking.sure_confidence || context_.tracking.confirm_detections <= 1;
  best->jumpTo(best_sight, frame.stamp, context_.tracking);
  followed_.push_back(std::move(best));
}

Pose ObjectTracker::cameraAt(double stamp) const {
  const CameraPlace* nearest = &camera_.back();
  for (const CameraPlace& place : camera_)
    if (std::abs(place.stamp - stamp) < std::abs(nearest->stamp - stamp)) nearest = &place;
  return nearest->fixed_from_camera;
}

/// One region, one object: of two tracks that explain the same pixels the weaker one is given up.
void ObjectTracker::resolveOverlaps() {
  for (size_t a = 0; a < followed_.size(); ++a)
    for (size_t b = a + 1; b < followed_.size(); ++b) {
      FollowedObject &one = *followed_[a], &other = *followed_[b];
      if (one.explained.box.empty() || other.explained.box.empty()) continue;
      const int smaller = std::min(cv::countNonZero(one.explained.mask), cv::countNonZero(other.explained.mask));
      if (overlap(one.explained, other.explained) <= kMaxOverlap * smaller) continue;
      FollowedObject& loser = one.strength() < other.strength() ? one : other;
      loser.track.end = TrackEnd::kReplaced;
      loser.explained = {};
    }
}

void ObjectTracker::explain(cv::Size size) {
  explained_ = cv::Mat::zeros(size, CV_8UC1);
  for (const auto& one : followed_) {
    const bool shown = one->track.end == TrackEnd::kNone &&
                       (one->track.state == TrackState::kSeen || one->track.state == TrackState::kDark);
    const bool awaited = one->track.confirmed || stamp_ - one->track.first_seen < kAwait;
    if (!shown || !awaited || one->explained.box.empty()) continue;
    const cv::Mat place = explained_(one->explained.box);
    const int value = one->track.confirmed ? kExplainedPixel : kUnconfirmedPixel;
    cv::max(place, one->explained.mask & value, place);
  }
}

/// Tells what there is, and what began and ended.
void ObjectTracker::collect(const std::vector<const FollowedObject*>& before, TrackingOutcome* outcome) {
  for (auto& one : followed_) {
    if (one->track.end == TrackEnd::kNone) {
      if (!one->track.confirmed) continue;
      outcome->tracks.push_back(one->track);
      if (std::find(before.begin(), before.end(), one.get()) == before.end()) outcome->found.push_back(one->track);
    } else if (std::find(before.begin(), before.end(), one.get()) != before.end()) {
      ended_.push_back(one->track);
    }
  }
  followed_.erase(std::remove_if(followed_.begin(), followed_.end(),
                                 [](const auto& one) { return one->track.end != TrackEnd::kNone; }),
                  followed_.end());
  outcome->lost.swap(ended_);
  std::sort(outcome->tracks.begin(), outcome->tracks.end(), [](const Track& a, const Track& b) {
    return std::tie(a.object, a.instance) < std::tie(b.object, b.instance);
  });
}

void ObjectTracker::setModels(std::shared_ptr<const PreparedModels> models) {
  for (const auto& one : followed_) {
    int object = models->count() - 1;
    while (object >= 0 && models->object(object).name != one->track.object) --object;
    one->track.object_index = object;
    if (object >= 0) continue;
    one->track.end = TrackEnd::kModelGone;
    if (one->track.confirmed) ended_.push_back(one->track);
  }
  followed_.erase(
      std::remove_if(followed_.begin(), followed_.end(), [](const auto& one) { return one->track.object_index < 0; }),
      followed_.end());
  waiting_.clear();  // their objects are numbered as in the models before
  context_.models = std::move(models);
}

int ObjectTracker::freeInstance(const std::string& object) const {
  std::set<int> used;
  for (const auto& one : followed_)
    if (one->track.object == object) used.insert(one->track.instance);
  int instance = 0;
  while (used.count(instance)) ++instance;
  return instance;
}

}  // namespace recognition
