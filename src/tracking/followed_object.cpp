#include "tracking/followed_object.h"

#include <algorithm>
#include <cmath>

#include "verification/confidence.h"

namespace recognition {
namespace {

constexpr double kHistory = 4.0;     // seconds; detections of frames that are older count as of the oldest
constexpr double kMaxOutside = 0.8;  // of the near side
constexpr double kHidden = 0.6;      // share of its known pixels that count as hidden, from which it is not aligned
constexpr double kHiddenFreeSpace = 0.2;  // what is seen through it beside, at most
constexpr double kMaxUnknown = 0.75;
constexpr double kSearchFreeSpace = 0.3;          // from which it is looked for beside its place
constexpr double kDark = 6.0, kDarkShare = 0.25;  // CIELAB L, and of the usual lightness
constexpr double kLooks = 0.5;                    // of the usual structure that it must show
constexpr double kMinStructure = 0.1;             // of a usual one, below which structure says nothing
// Of the confidence that a detection must have: what is known needs less. Chosen by hand on the film of seed 11 of
// doc/results.md.
constexpr double kStays = 0.5;
constexpr double kCompareEvery = 0.5;                            // seconds, at full resolution
constexpr double kLearn = 0.1;                                   // weight of a frame in what is usual
constexpr double kTrust = 0.3, kDistrust = 0.4, kForget = 30.0;  // seconds in which confidence follows
constexpr double kMaxMove = 0.12;  // metres that the alignment may move it beside what was expected

/// `of` by features, the rest by pixels.
Evidence merged(const Evidence& of, const Evidence& pixels) {
  Evidence out = pixels;
  out.inliers = of.inliers;
  out.features = of.features;
  out.matched = of.matched;
  out.significance = of.significance;
  out.segment_share = of.segment_share;
  return out;
}

/// Covariance in axes turned by `rotation`.
Matrix6d turned(const Matrix6d& covariance, const Eigen::Matrix3d& rotation) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = rotation;
  return turn * covariance * turn.transpose();
}

void doubt(TrackEnd reason, Sight* sight) {
  sight->state = TrackState::kDoubtful;
  sight->doubt = reason;
}

bool isHidden(const DepthShares& shares) {
  return shares.hidden >= kHidden * (1.0 - shares.unknown) && shares.free_space <= kHiddenFreeSpace;
}

}  // namespace

FollowedObject::FollowedObject(const VerifiedHypothesis& detection, const ObjectModel& object,
                               const PreparedModel& model, const Pose& fixed_from_object, double stamp)
    : evidence(detection.evidence),
      centre_(model.centre.cast<double>()),
      filter_(centre_, fixed_from_object, stamp),
      stamp_(stamp),
      frame_confidence_(detection.confidence) {
  track.object = object.name;
  track.object_index = detection.hypothesis.object;
  track.fixed_from_object = fixed_from_object;
  track.confidence = detection.confidence;
  track.visible = detection.scores.visible;
  track.detections = 1;
  track.first_seen = track.last_seen = stamp;
  track.source = detection.hypothesis.source;
  places_.push_back({stamp, fixed_from_object});
}

Sight FollowedObject::look(const FrameInTime& frame, const TrackingContext& context, const Pose* at) const {
  Sight sight;
  const Pose expected = at ? *at : filter_.predicted(frame.stamp);
  sight.fixed_from_object = expected;
  TrackVerification test(context.models->at(track.object_index), context.models->object(track.object_index),
                         context.verification, frame.frame, frame.fixed_from_camera.inverse() * expected);
  sight.shares = test.look();
  if (sight.shares.pixels == 0 || sight.shares.outside > kMaxOutside) {
    sight.state = TrackState::kOutOfView;
    return sight;
  }
  if (isHidden(sight.shares)) sight.state = TrackState::kHidden;
  if (sight.shares.unknown > kMaxUnknown) sight.state = TrackState::kNoDepth;
  if (sight.state != TrackState::kDoubtful) return sight;
  sight.lightness = test.lightness();
  const bool dark = sight.lightness < std::max(kDark, kDarkShare * usual_lightness_);
  if (sight.shares.free_space > kSearchFreeSpace) test.searchAround();
  const bool aligned = test.align(!dark, usual_colors_);
  sight.shares = test.look();
  if (isHidden(sight.shares)) {
    sight.state = TrackState::kHidden;
    return sight;
  }
  if (!aligned || sight.shares.free_space > context.verification.max_free_space) {
    doubt(TrackEnd::kTakenAway, &sight);
    return sight;
  }
  sight.colors = test.colors();
  sight.fixed_from_object = frame.fixed_from_camera * test.pose();
  sight.covariance = turned(test.covariance(), frame.fixed_from_camera.linear());
  sight.frame_noise = turned(test.frameNoise(), frame.fixed_from_camera.linear());
  sight.measured = ((sight.fixed_from_object * centre_) - (expected * centre_)).norm() < kMaxMove;
  if (!sight.measured)
    doubt(TrackEnd::kTakenAway, &sight);
  else if (dark)
    sight.state = TrackState::kDark;
  else
    judge(test, frame, context, &sight);
  if (sight.measured) sight.explained = test.explained();
  return sight;
}

/// By its looks: coarsely in each frame, in full now and then and where the coarse look is in doubt.
void FollowedObject::judge(const TrackVerification& test, const FrameInTime& frame, const TrackingContext& context,
                           Sight* sight) const {
  const Appearance coarse = test.compareCoarsely();
  sight->coarse_structure = coarse.structure;
  sight->state = TrackState::kSeen;
  const bool usual = fitted_ && coarse.structure >= kLooks * usual_coarse_;
  if (usual && frame.stamp - compared_ < kCompareEvery) return;
  sight->compared = true;
  sight->evidence = merged(evidence, test.compare());
  sight->confidence = confidence(sight->evidence, track.source);
  const bool fits = sight->confidence >= kStays * context.verification.min_confidence && looksRight(*sight);
  if (!fits) {
    doubt(TrackEnd::kLooksOther, sight);
    sight->measured = false;
  }
}

bool FollowedObject::looksRight(const Sight& sight) const {
  return usual_structure_ < kMinStructure || sight.evidence.structure >= kLooks * usual_structure_;
}

void FollowedObject::take(const Sight& sight, double stamp, const TrackingParameters& parameters) {
  const double seconds = stamp - stamp_;
  stamp_ = stamp;
  if (sight.measured)
    filter_.measure(stamp, sight.fixed_from_object, sight.frame_noise);
  else
    filter_.hold(stamp);
  if (sight.measured) track.covariance = sight.covariance;
  if (sight.state == TrackState::kSeen) learn(sight);
  if (sight.compared) {
    compared_ = stamp;
    fitted_ = sight.state == TrackState::kSeen;
  }
  updateConfidence(sight, seconds);
  track.state = sight.state;
  track.fixed_from_object = filter_.pose();
  track.velocity = filter_.velocity();
  track.visible = (1.0 - sight.shares.hidden) * (1.0 - sight.shares.outside);
  explained = sight.explained;
  places_.push_back({stamp, track.fixed_from_object});
  while (places_.front().stamp < stamp - kHistory) places_.pop_front();
  track.end = endBy(sight, stamp, parameters);
}

void FollowedObject::jumpTo(const Sight& sight, double stamp, const TrackingParameters& parameters) {
  filter_ = PoseFilter(centre_, sight.fixed_from_object, stamp);
  take(sight, stamp, parameters);
}

void FollowedObject::confirm(const VerifiedHypothesis& detection, const TrackingParameters& parameters) {
  evidence = merged(detection.evidence, evidence);
  track.source = detection.hypothesis.source;
  ++track.detections;
  track.confirmed = track.confirmed || track.detections >= parameters.confirm_detections;
}

void FollowedObject::learn(const Sight& sight) {
  const auto towards = [](double value, double* usual) {
    *usual = *usual == 0.0 ? value : *usual + kLearn * (value - *usual);
  };
  towards(sight.coarse_structure, &usual_coarse_);
  towards(sight.lightness, &usual_lightness_);
  towards(sight.colors, &usual_colors_);
  if (!sight.compared) return;
  towards(sight.evidence.structure, &usual_structure_);
  evidence = sight.evidence;
  frame_confidence_ = sight.confidence;
}

void FollowedObject::updateConfidence(const Sight& sight, double seconds) {
  double& confidence = track.confidence;
  if (sight.state == TrackState::kSeen)
    confidence += (frame_confidence_ - confidence) * (1.0 - std::exp(-seconds / kTrust));
  else
    confidence *= std::exp(-seconds / (sight.state == TrackState::kDoubtful ? kDistrust : kForget));
}

TrackEnd FollowedObject::endBy(const Sight& sight, double stamp, const TrackingParameters& parameters) {
  const auto since = [stamp](bool holds, double* begin) {
    if (!holds)
      *begin = -1.0;
    else if (*begin < 0.0)
      *begin = stamp;
    return holds ? stamp - *begin : 0.0;
  };
  if (sight.state == TrackState::kSeen) track.last_seen = stamp;
  // What neither agrees nor contradicts does not end a doubt.
  if (sight.state == TrackState::kSeen || sight.state == TrackState::kDoubtful) {
    const double doubtful = since(sight.state == TrackState::kDoubtful, &doubtful_since_);
    if (sight.state == TrackState::kDoubtful && doubtful >= parameters.lost_after) return sight.doubt;
  }
  const double unseen = since(sight.state != TrackState::kSeen, &unseen_since_);
  switch (sight.state) {
    case TrackState::kSeen:
    case TrackState::kDoubtful:
      return TrackEnd::kNone;
    case TrackState::kHidden:
      return unseen > parameters.hidden_for ? TrackEnd::kNotSeen : TrackEnd::kNone;
    case TrackState::kNoDepth:
    case TrackState::kDark:
      return unseen > parameters.unseen_for ? TrackEnd::kNotSeen : TrackEnd::kNone;
    case TrackState::kOutOfView:
      return unseen > parameters.forget_after ? TrackEnd::kOutOfView : TrackEnd::kNone;
  }
  return TrackEnd::kNone;
}

Pose FollowedObject::placeAt(double stamp) const {
  const Place* nearest = &places_.front();
  for (const Place& place : places_)
    if (std::abs(place.stamp - stamp) < std::abs(nearest->stamp - stamp)) nearest = &place;
  return nearest->fixed_from_object;
}

double FollowedObject::strength() const { return explanatoryStrength(evidence, track.confidence); }

}  // namespace recognition
