#include <gtest/gtest.h>

#include "ros/frame_pacer.h"

namespace recognition {
namespace {

ros::WallTime at(double seconds) { return ros::WallTime(100.0 + seconds); }

TEST(FramePacer, hasNoLimitUntilTheLastStageAnswers) {
  FramePacer pacer(2, 1.0);
  for (int i = 1; i < 10; ++i) EXPECT_TRUE(pacer.admit(ros::Time(i), at(0.1 * i)));
}

TEST(FramePacer, keepsToItsLimitOnceAnswered) {
  FramePacer pacer(2, 1.0);
  pacer.finished(ros::Time(1), at(0.0));
  EXPECT_TRUE(pacer.admit(ros::Time(2), at(0.1)));
  EXPECT_TRUE(pacer.admit(ros::Time(3), at(0.2)));
  EXPECT_FALSE(pacer.admit(ros::Time(4), at(0.3)));
  pacer.finished(ros::Time(2), at(0.4));
  EXPECT_TRUE(pacer.admit(ros::Time(5), at(0.5)));
  EXPECT_FALSE(pacer.admit(ros::Time(6), at(0.6)));
}

TEST(FramePacer, countsOlderFramesThanTheAnsweredAsGone) {
  FramePacer pacer(2, 1.0);
  pacer.finished(ros::Time(1), at(0.0));
  pacer.admit(ros::Time(2), at(0.1));
  pacer.admit(ros::Time(3), at(0.2));
  pacer.finished(ros::Time(3), at(0.3));
  EXPECT_TRUE(pacer.admit(ros::Time(4), at(0.4)));
  EXPECT_TRUE(pacer.admit(ros::Time(5), at(0.4)));
}

TEST(FramePacer, aBadFrameTakesNoPlaceAndIsNotLost) {
  FramePacer pacer(1, 1.0);
  pacer.finished(ros::Time(1), at(0.0));
  EXPECT_TRUE(pacer.admit(ros::Time(2), at(0.1)));
  pacer.withdraw(ros::Time(2));
  EXPECT_TRUE(pacer.admit(ros::Time(3), at(0.2)));
  pacer.finished(ros::Time(3), at(0.3));
  EXPECT_EQ(pacer.lost(), 0u);
}

TEST(FramePacer, losesPatienceAndGoesOn) {
  FramePacer pacer(1, 1.0);
  pacer.finished(ros::Time(1), at(0.0));
  EXPECT_TRUE(pacer.admit(ros::Time(2), at(0.1)));
  EXPECT_FALSE(pacer.admit(ros::Time(3), at(0.9)));
  EXPECT_TRUE(pacer.admit(ros::Time(4), at(1.1)));
  EXPECT_TRUE(pacer.admit(ros::Time(5), at(1.2)));
}

TEST(FramePacer, forgetsWhatIsInsideWhenTimeGoesBack) {
  FramePacer pacer(1, 1.0);
  pacer.finished(ros::Time(1), at(0.0));
  EXPECT_TRUE(pacer.admit(ros::Time(20), at(0.1)));
  EXPECT_TRUE(pacer.admit(ros::Time(2), at(0.2)));
  EXPECT_FALSE(pacer.admit(ros::Time(3), at(0.3)));
}

TEST(FramePacer, countsWhatIsAdmittedAndNeverAnswered) {
  FramePacer pacer(2, 1.0);
  for (int i = 1; i <= 3; ++i) pacer.admit(ros::Time(i), at(0.0));
  pacer.finished(ros::Time(2), at(0.1));
  EXPECT_EQ(pacer.lost(), 1u) << "the first";
  pacer.finished(ros::Time(3), at(0.2));
  EXPECT_EQ(pacer.lost(), 1u);
}

TEST(FramePacer, countsALateAnswerAsOne) {
  FramePacer pacer(1, 1.0);
  pacer.finished(ros::Time(1), at(0.0));
  pacer.admit(ros::Time(2), at(0.1));
  pacer.admit(ros::Time(3), at(1.1));  // without patience for the one before
  pacer.finished(ros::Time(2), at(1.2));
  EXPECT_EQ(pacer.lost(), 0u);
  pacer.admit(ros::Time(4), at(1.3));
  pacer.finished(ros::Time(4), at(1.4));
  EXPECT_EQ(pacer.lost(), 1u) << "the third";
}

TEST(FramePacer, countsNothingAsLostWhileNobodyAnswers) {
  FramePacer pacer(1, 1.0);
  for (int i = 1; i <= 1000; ++i) EXPECT_TRUE(pacer.admit(ros::Time(i), at(0.01 * i)));
  EXPECT_TRUE(pacer.admit(ros::Time(1), at(11.0)));
  EXPECT_EQ(pacer.lost(), 0u);
}

}  // namespace
}  // namespace recognition
