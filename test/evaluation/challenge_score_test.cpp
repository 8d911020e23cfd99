#include "rgbd_recognition/evaluation/challenge_score.h"

#include <gtest/gtest.h>

namespace recognition {
namespace {

ScoredInstance at(int object, double x, double degrees = 0.0) {
  ScoredInstance instance;
  instance.object_id = object;
  instance.camera_from_object.translation() = Eigen::Vector3d(x, 0.0, 1.0);
  instance.camera_from_object.linear() =
      Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return instance;
}

TEST(ChallengeScore, Ramps) {
  EXPECT_DOUBLE_EQ(translationScore(0.01), 1.0);
  EXPECT_DOUBLE_EQ(translationScore(0.02), 0.5);
  EXPECT_DOUBLE_EQ(translationScore(0.03), 0.0);
  EXPECT_DOUBLE_EQ(rotationScore(2.0), 1.0);
  EXPECT_DOUBLE_EQ(rotationScore(11.0), 0.5);
  EXPECT_DOUBLE_EQ(rotationScore(25.0), 0.0);
}

TEST(ChallengeScore, PerfectFrameScoresItsInstances) {
  const FrameScore score = scoreFrame({at(1, 0.0), at(2, 0.3)}, {at(1, 0.0), at(2, 0.3)});
  EXPECT_EQ(score.hits.size(), 2u);
  EXPECT_DOUBLE_EQ(score.score, 2.0);
}

TEST(ChallengeScore, ByHand) {
  // One hit 2 cm and 11 degrees off (accuracy 0.5), one miss, one false positive: 0.5 max(0, 1 - 0.5 - 1 + 0.5) = 0;
  // without the false positive 0.5 (1 - 0.5 + 0.5) = 0.5.
  const std::vector<ScoredInstance> truth = {at(1, 0.0), at(2, 0.3)};
  EXPECT_NEAR(scoreFrame({at(1, 0.02, 11.0), at(3, 0.0)}, truth).score, 0.0, 1e-9);
  const FrameScore score = scoreFrame({at(1, 0.02, 11.0)}, truth);
  EXPECT_NEAR(score.score, 0.5, 1e-9);
  EXPECT_EQ(score.missed, std::vector<int>{1});
}

TEST(ChallengeScore, FloorIsPerFrame) {
  EXPECT_DOUBLE_EQ(scoreFrame({at(5, 0.0), at(6, 0.0)}, {at(1, 0.0)}).score, 0.0);
  EXPECT_DOUBLE_EQ(scoreFrame({}, {}).score, 0.0);
}

TEST(ChallengeScore, DuplicatesTakeClosestPairs) {
  // Two instances of object 1; the detections come in the other order; a third is false.
  const FrameScore score = scoreFrame({at(1, 0.505), at(1, 0.001), at(1, 0.2)}, {at(1, 0.0), at(1, 0.5)});
  ASSERT_EQ(score.hits.size(), 2u);
  for (const Hit& hit : score.hits) EXPECT_EQ(hit.truth, hit.detection == 0 ? 1 : 0);
  EXPECT_EQ(score.false_positives, std::vector<int>{2});
}

}  // namespace
}  // namespace recognition
