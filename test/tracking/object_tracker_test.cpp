#include "tracking/object_tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "alignment/any_threads.h"
#include "alignment/synthetic_scene.h"
#include "search/frame_search.h"
#include "tracking/explained_pixels.h"

namespace recognition {
namespace {

using synthetic::poseAt;

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr double kFrame = 1.0 / 30.0;

/// A box, a can, a twin of the box with another texture, and a plain occluder, seen 30 times a second.
class Sequence : public ::testing::Test {
 protected:
  Sequence()
      : box_(synthetic::box(1)),
        can_(synthetic::can(2)),
        twin_(synthetic::box(99)),
        models_{synthetic::makeModel(box_, "box"), synthetic::makeModel(can_, "can"),
                synthetic::makeModel(twin_, "twin")},
        prepared_(std::make_shared<const PreparedModels>(synthetic::databaseOf(models_))),
        tracker_({}, {}, prepared_) {}

  std::unique_ptr<synthetic::Scene> render(const std::vector<synthetic::Placed>& placed) {
    sensor_.seed = static_cast<std::uint32_t>(1000.0 * stamp_);
    std::vector<ObjectModel> shown;
    for (const synthetic::Placed& one : placed) shown.push_back(models_[one.solid.shape == can_.shape ? 1 : 0]);
    return synthetic::render(placed, shown, sensor_);
  }

  /// The next frame.
  TrackingOutcome see(const std::vector<synthetic::Placed>& placed, const Pose& camera = Pose::Identity()) {
    stamp_ += kFrame;
    scene_ = render(placed);
    return tracker_.follow(stamp_, scene_->frame, camera);
  }

  /// What detection says of an object of the last frame; the pose is off as that of a real detection.
  VerifiedHypothesis detection(int object, const Pose& camera_from_object, double confidence = 0.95) const {
    VerifiedHypothesis found;
    found.hypothesis.object = object;
    found.hypothesis.camera_from_object = found.camera_from_object =
        synthetic::disturbed(camera_from_object, 0.003, 1.0, 4);
    found.confidence = confidence;
    found.evidence.inliers = 25;
    found.evidence.significance = 8.0;
    found.evidence.segment_share = 0.9;
    return found;
  }

  void detect(const std::vector<VerifiedHypothesis>& detections) { tracker_.add(stamp_, detections); }

  /// A box and a can, found.
  void begin() {
    see(both());
    detect({detection(0, box_at_), detection(1, can_at_)});
    ASSERT_EQ(2u, see(both()).found.size());
  }

  std::vector<synthetic::Placed> both() const { return {{box_, box_at_}, {can_, can_at_}}; }

  static void expectNear(const Pose& found, const Pose& truth, double metres, double degrees) {
    EXPECT_LT(translationDistance(found, truth), metres);
    EXPECT_LT(rotationDistance(found, truth), degrees * kDegree);
  }

  synthetic::Solid box_, can_, twin_;
  Pose box_at_ = poseAt({-0.05, 0.0, 0.8}), can_at_ = poseAt({0.15, 0.05, 0.9});
  std::vector<ObjectModel> models_;
  std::shared_ptr<const PreparedModels> prepared_;
  ObjectTracker tracker_;
  synthetic::Sensor sensor_;
  std::unique_ptr<synthetic::Scene> scene_;
  double stamp_ = 100.0;
};

TEST_F(Sequence, StandingObjectsStayAndDoNotJitter) {
  begin();
  for (int i = 0; i < 20; ++i) see(both());
  const TrackingOutcome before = see(both());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  for (int i = 0; i < 20; ++i) {
    const TrackingOutcome outcome = see(both());
    ASSERT_EQ(2u, outcome.tracks.size());
    EXPECT_TRUE(outcome.found.empty());
    EXPECT_EQ("box", outcome.tracks[0].object);
    EXPECT_EQ(TrackState::kSeen, outcome.tracks[0].state);
    expectNear(outcome.tracks[0].fixed_from_object, box_at_, 0.003, 1.0);
    expectNear(outcome.tracks[1].fixed_from_object, can_at_, 0.003, 1.5);
    EXPECT_GT(outcome.tracks[0].confidence, 0.8);
    EXPECT_TRUE(outcome.tracks[0].velocity.isZero());
    const double deviation = std::sqrt(outcome.tracks[0].covariance(2, 2));  // the scale of depth may be off throughout
    EXPECT_GT(deviation, 0.003);
    EXPECT_LT(deviation, 0.015);
    const Eigen::Vector3d off =
        outcome.tracks[0].fixed_from_object.translation() - before.tracks[0].fixed_from_object.translation();
    sum += off;
    squares += off.cwiseAbs2();
  }
  EXPECT_LT((squares / 20 - (sum / 20).cwiseAbs2()).cwiseMax(0.0).cwiseSqrt().norm(), 0.0005);
  const Eigen::Vector2d middle = sensor_.camera.project(box_at_.translation());
  EXPECT_EQ(255, tracker_.explained().at<std::uint8_t>(cvRound(middle.y()), cvRound(middle.x())));
  EXPECT_EQ(0, tracker_.explained().at<std::uint8_t>(20, 20));
}

TEST_F(Sequence, FollowsAnObjectThatMovesAndTurns) {
  begin();
  const Pose start = box_at_;
  for (int i = 1; i <= 24; ++i) {
    const double seconds = kFrame * i,
                 way = 0.3 * std::max(seconds - 0.1, 0.5 * seconds * std::min(1.0, seconds / 0.2));
    box_at_.translation() = start.translation() - Eigen::Vector3d(way * 0.6, way * 0.2, -0.1 * way);
    const double angle = way / 0.3 * 60.0 * kDegree;
    box_at_.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) * start.linear();
    const TrackingOutcome outcome = see(both());
    ASSERT_EQ(2u, outcome.tracks.size());
    EXPECT_EQ(TrackState::kSeen, outcome.tracks[0].state);
    expectNear(outcome.tracks[0].fixed_from_object, box_at_, 0.012, 4.0);
    EXPECT_TRUE(outcome.tracks[1].velocity.isZero());
  }
}

TEST_F(Sequence, FollowsACanThatTurnsAboutItsAxis) {
  begin();
  const Pose start = can_at_;
  for (int i = 1; i <= 30; ++i) {
    const double angle = 60.0 * kDegree * std::max(0.0, kFrame * i - 0.1);
    can_at_ = start * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY());
    const TrackingOutcome outcome = see(both());
    ASSERT_EQ(2u, outcome.tracks.size());
    expectNear(outcome.tracks[1].fixed_from_object, can_at_, 0.01, 4.0);
  }
}

TEST_F(Sequence, StandsStillInTheFixedFrameOfAMovingCamera) {
  begin();
  const Pose box_in_room = box_at_, can_in_room = can_at_;
  for (int i = 1; i <= 15; ++i) {
    Pose camera = Pose::Identity();
    camera.translation() = Eigen::Vector3d(0.012 * i, 0.0, 0.0);
    camera.linear() = Eigen::AngleAxisd(-1.5 * kDegree * i, Eigen::Vector3d::UnitY()).toRotationMatrix();
    box_at_ = camera.inverse() * box_in_room;
    can_at_ = camera.inverse() * can_in_room;
    const TrackingOutcome outcome = see(both(), camera);
    ASSERT_EQ(2u, outcome.tracks.size());
    expectNear(outcome.tracks[0].fixed_from_object, box_in_room, 0.004, 1.5);
  }
}

TEST_F(Sequence, BringsADetectionOfAnEarlierFrameToThePresent) {
  begin();
  TrackingOutcome outcome;
  const double then = stamp_ + kFrame;
  for (int i = 0; i < 10; ++i) {
    if (i == 1) tracker_.add(then, {});
    box_at_.translation().x() -= 0.006;
    outcome = see(both());
  }
  // A search of the first of these frames ends now: the box has moved since, and the can is where it was.
  Pose box_then = box_at_;
  box_then.translation().x() += 9 * 0.006;
  tracker_.add(then, {detection(0, box_then), detection(1, can_at_)});
  outcome = see(both());
  ASSERT_EQ(2u, outcome.tracks.size());
  EXPECT_EQ(2, outcome.tracks[0].detections);
  expectNear(outcome.tracks[0].fixed_from_object, box_at_, 0.008, 3.0);
}

TEST_F(Sequence, KeepsWhatIsHiddenAndMarksIt) {
  begin();
  for (int i = 0; i < 5; ++i) see(both());
  std::vector<synthetic::Placed> covered = both();
  Pose before_it = poseAt({-0.03, 0.0, 0.5});
  covered.push_back({{synthetic::Solid::Shape::kBox, {0.09, 0.1, 0.02}, twin_.texture}, before_it});
  for (int i = 0; i < 40; ++i) {
    const TrackingOutcome outcome = see(covered);
    ASSERT_EQ(2u, outcome.tracks.size()) << i;
    EXPECT_EQ(TrackState::kHidden, outcome.tracks[0].state);
    EXPECT_LT(outcome.tracks[0].visible, 0.5);
    EXPECT_EQ(TrackState::kSeen, outcome.tracks[1].state);
  }
  const TrackingOutcome again = see(both());
  ASSERT_EQ(2u, again.tracks.size());
  EXPECT_TRUE(again.found.empty());
  EXPECT_EQ(TrackState::kSeen, again.tracks[0].state);
  expectNear(again.tracks[0].fixed_from_object, box_at_, 0.004, 1.5);
}

TEST_F(Sequence, KeepsItsTracksThroughASecondWithoutDepth) {
  begin();
  for (int i = 0; i < 30; ++i) {
    stamp_ += kFrame;
    scene_ = render(both());
    scene_->frame.depth = cv::Mat::zeros(scene_->depth.size(), CV_32FC1);
    const TrackingOutcome outcome = tracker_.follow(stamp_, scene_->frame);
    ASSERT_EQ(2u, outcome.tracks.size());
    EXPECT_EQ(TrackState::kNoDepth, outcome.tracks[0].state);
  }
  EXPECT_EQ(TrackState::kSeen, see(both()).tracks.at(0).state);
}

TEST_F(Sequence, GivesUpWhatIsTakenAway) {
  begin();
  std::vector<Track> lost;
  int frames = 0;
  for (; frames < 60 && lost.empty(); ++frames) {
    const TrackingOutcome outcome = see({{can_, can_at_}});
    lost = outcome.lost;
    for (const Track& track : outcome.tracks) {
      if (track.object != "box") continue;
      EXPECT_EQ(TrackState::kDoubtful, track.state);
    }
  }
  ASSERT_EQ(1u, lost.size());
  EXPECT_EQ("box", lost[0].object);
  EXPECT_EQ(TrackEnd::kTakenAway, lost[0].end);
  EXPECT_LT(lost[0].confidence, 0.5);
  EXPECT_NEAR(frames * kFrame, tracker_.parameters().lost_after, 3 * kFrame);
  EXPECT_EQ(1u, see({{can_, can_at_}}).tracks.size());
}

TEST_F(Sequence, ATwinInItsPlaceIsNotTakenForIt) {
  begin();
  for (int i = 0; i < 10; ++i) see(both());
  std::vector<Track> lost;
  for (int i = 0; i < 60 && lost.empty(); ++i) {
    const TrackingOutcome outcome = see({{twin_, box_at_}, {can_, can_at_}});
    lost = outcome.lost;
    for (const Track& track : outcome.tracks) {
      if (track.object != "box" || i == 0) continue;
      EXPECT_EQ(TrackState::kDoubtful, track.state);
    }
  }
  ASSERT_EQ(1u, lost.size());
  EXPECT_EQ("box", lost[0].object);
  EXPECT_EQ(TrackEnd::kLooksOther, lost[0].end);
}

TEST_F(Sequence, LightsGoOffAndOn) {
  begin();
  for (int i = 0; i < 5; ++i) see(both());
  const synthetic::Sensor bright = sensor_;
  sensor_.gain = 0.02;
  for (int i = 0; i < 30; ++i) {
    const TrackingOutcome outcome = see(both());
    ASSERT_EQ(2u, outcome.tracks.size());
    EXPECT_EQ(TrackState::kDark, outcome.tracks[0].state);
  }
  sensor_ = bright;
  const TrackingOutcome outcome = see(both());
  ASSERT_EQ(2u, outcome.tracks.size());
  EXPECT_EQ(TrackState::kSeen, outcome.tracks[0].state);
  expectNear(outcome.tracks[0].fixed_from_object, box_at_, 0.004, 1.5);
  EXPECT_TRUE(outcome.found.empty());
}

TEST_F(Sequence, DoubledAndLateFramesAreIgnored) {
  begin();
  const TrackingOutcome first = see(both());
  for (const double late : {0.0, 0.5 * kFrame, 3 * kFrame}) {
    const TrackingOutcome again = tracker_.follow(stamp_ - late, scene_->frame);
    EXPECT_TRUE(again.ignored);
    EXPECT_FALSE(again.restarted);
    EXPECT_EQ(first.tracks.size(), again.tracks.size());
  }
  EXPECT_FALSE(see(both()).ignored);
}

TEST_F(Sequence, AClockThatIsSetBackLosesAll) {
  begin();
  stamp_ = 10.0;
  const TrackingOutcome outcome = see(both());
  EXPECT_TRUE(outcome.restarted);
  EXPECT_TRUE(outcome.tracks.empty());
  ASSERT_EQ(2u, outcome.lost.size());
  EXPECT_EQ(TrackEnd::kClockSetBack, outcome.lost[0].end);
}

TEST_F(Sequence, StampsThatJumpAheadKeepWhatIsStillThere) {
  begin();
  stamp_ += 100.0;
  const TrackingOutcome outcome = see(both());
  EXPECT_EQ(2u, outcome.tracks.size());
  EXPECT_TRUE(outcome.lost.empty());
}

TEST_F(Sequence, AnUnsureDetectionMustBeRepeated) {
  see(both());
  detect({detection(0, box_at_, 0.6)});
  EXPECT_TRUE(see(both()).tracks.empty());
  const cv::Mat explained = tracker_.explained();
  EXPECT_EQ(0, cv::countNonZero(explained == kExplainedPixel));
  EXPECT_GT(cv::countNonZero(explained == kUnconfirmedPixel), 1000);  // so that it is looked for again
  detect({detection(0, box_at_, 0.6)});
  EXPECT_EQ(1u, see(both()).found.size());
}

TEST_F(Sequence, ADetectionThatThePresentFrameDoesNotShowBeginsNothing) {
  see(both());
  detect({detection(0, poseAt({0.3, -0.2, 0.8}))});
  EXPECT_TRUE(see(both()).tracks.empty());
  EXPECT_EQ(1, tracker_.dropped());
}

TEST_F(Sequence, TwoInstancesKeepTheirNumbers) {
  const Pose left = poseAt({-0.2, 0, 0.8}), right = poseAt({0.1, 0, 0.8});
  see({{box_, left}, {box_, right}});
  detect({detection(0, right), detection(0, left)});
  ASSERT_EQ(2u, see({{box_, left}, {box_, right}}).found.size());
  detect({detection(0, left), detection(0, right)});
  const TrackingOutcome outcome = see({{box_, left}, {box_, right}});
  ASSERT_EQ(2u, outcome.tracks.size());
  EXPECT_EQ(0, outcome.tracks[0].instance);
  EXPECT_GT(outcome.tracks[0].fixed_from_object.translation().x(), 0.0);
  EXPECT_EQ(2, outcome.tracks[1].detections);
}

TEST_F(Sequence, GoesOnWithOtherModelsByName) {
  begin();
  tracker_.setModels(std::make_shared<const PreparedModels>(synthetic::databaseOf({models_[2], models_[1]})));
  const TrackingOutcome outcome = see(both());
  ASSERT_EQ(1u, outcome.tracks.size());
  EXPECT_EQ("can", outcome.tracks[0].object);
  ASSERT_EQ(1u, outcome.lost.size());
  EXPECT_EQ(TrackEnd::kModelGone, outcome.lost[0].end);
}

TEST_F(Sequence, RefusesParametersOutOfRange) {
  TrackingParameters parameters;
  parameters.confirm_detections = 0;
  EXPECT_THROW(ObjectTracker(parameters, {}, prepared_), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
