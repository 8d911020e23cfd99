#include "evaluation/sequence_score.h"

#include <gtest/gtest.h>

#include <cmath>

namespace recognition {
namespace {

constexpr double kRate = 30.0;

Pose poseAt(double x, double degrees = 0.0) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, 0.0, 1.0);
  pose.linear() =
      Eigen::AngleAxisd(degrees * 3.14159265358979323846 / 180.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

/// A film of one standing object, answered from frame `first` on with an error that alternates.
std::vector<SequenceFrame> film(int frames, int first, double error, int instance = 0) {
  std::vector<SequenceFrame> film;
  for (int i = 0; i < frames; ++i) {
    SequenceFrame frame;
    frame.stamp = 10.0 + i / kRate;
    frame.truth = {{7, poseAt(0.0), 1.0}};
    if (i >= first) frame.answers = {{7, instance, poseAt(i % 2 == 0 ? error : -error)}};
    frame.seconds = 0.01;
    film.push_back(frame);
  }
  return film;
}

TEST(SequenceScore, CountsFramesAndTimesAndJitter) {
  const SequenceScore score = scoreSequence(film(90, 15, 0.001));
  EXPECT_EQ(score.frames, 90);
  EXPECT_EQ(score.visible, 90);
  EXPECT_EQ(score.tight, 75);
  EXPECT_EQ(score.loose, 75);
  ASSERT_EQ(score.first_pose.size(), 1u);
  EXPECT_NEAR(score.first_pose[0], 0.5, 1e-9);
  EXPECT_NEAR(score.jitter_translation, 0.001, 1e-5);
  EXPECT_NEAR(score.jitter_rotation, 0.0, 1e-6);
  EXPECT_EQ(score.switches + score.false_tracks + score.never_found, 0);
  EXPECT_NE(sequenceText("tracking", score).find("1.00 mm"), std::string::npos);
  EXPECT_NE(sequenceJson(score).find("\"jitter_mm\": 0.99"), std::string::npos);
}

TEST(SequenceScore, ACoarsePoseIsLooseOnly) {
  const SequenceScore score = scoreSequence(film(30, 0, 0.02));
  EXPECT_EQ(score.tight, 0);
  EXPECT_EQ(score.loose, 30);
}

TEST(SequenceScore, TellsSwitchesFalseTracksAndWhatIsNeverFound) {
  std::vector<SequenceFrame> frames = film(30, 0, 0.0);
  for (size_t i = 10; i < 30; ++i) frames[i].answers[0].instance = 1;
  frames[20].answers.push_back({8, 0, poseAt(0.0)});  // not there at all
  frames[21].answers.push_back({7, 2, poseAt(0.3)});  // far off
  for (SequenceFrame& frame : frames) frame.truth.push_back({9, poseAt(1.0), 0.5});
  const SequenceScore score = scoreSequence(frames);
  EXPECT_EQ(score.switches, 1);
  EXPECT_EQ(score.false_tracks, 2);
  EXPECT_EQ(score.false_frames, 2);
  EXPECT_EQ(score.never_found, 1);
  EXPECT_EQ(score.visible, 60);
}

TEST(SequenceScore, HiddenInstancesAreNotAskedForAndMovingOnesDoNotJitter) {
  std::vector<SequenceFrame> frames = film(60, 0, 0.0);
  for (size_t i = 0; i < 60; ++i) {
    frames[i].truth[0].camera_from_object = frames[i].answers[0].camera_from_object =
        poseAt(0.01 * static_cast<double>(i));
    if (i >= 30) frames[i].truth[0].visibility = 0.1;
  }
  const SequenceScore score = scoreSequence(frames);
  EXPECT_EQ(score.visible, 30);
  EXPECT_EQ(score.standing, 0);
}

TEST(SequenceScore, FilmsAddUp) {
  SequenceScore all = scoreSequence(film(90, 0, 0.001));
  all.add(scoreSequence(film(90, 30, 0.003)));
  EXPECT_EQ(all.frames, 180);
  EXPECT_EQ(all.loose, 150);
  EXPECT_EQ(all.first_pose.size(), 2u);
  EXPECT_GT(all.jitter_translation, 0.001);
  EXPECT_LT(all.jitter_translation, 0.003);
}

}  // namespace
}  // namespace recognition
