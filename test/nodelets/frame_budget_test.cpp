#include <gtest/gtest.h>

#include "ros/frame_budget.h"

namespace recognition {
namespace {

const ros::WallTime kStart(1000.0);
ros::WallTime after(double seconds) { return kStart + ros::WallDuration(seconds); }

TEST(FrameBudget, withoutLimitAllIsAffordable) {
  FrameBudget budget;
  budget.begin(ros::Time(1.0), kStart);
  budget.measured(10.0, 1.0);
  EXPECT_EQ(budget.workLeft(after(100.0)), 0.0);
  EXPECT_FALSE(budget.exceeded(after(1e6)));
}

TEST(FrameBudget, countsTheEarlierStagesOfTheFrame) {
  FrameBudget budget(1.0);
  budget.spentEarlier(ros::Time(1.0), 0.2, kStart);
  budget.spentEarlier(ros::Time(2.0), 9.0, kStart);
  budget.spentEarlier(ros::Time(1.0), 0.3, after(0.1));
  budget.begin(ros::Time(1.0), after(0.2));
  EXPECT_NEAR(budget.spent(after(0.3)), 0.7, 1e-9);
  EXPECT_FALSE(budget.exceeded(after(0.5)));
  EXPECT_TRUE(budget.exceeded(after(0.7)));
}

TEST(FrameBudget, turnsTheTimeLeftIntoWork) {
  FrameBudget budget(1.0);
  budget.begin(ros::Time(1.0), kStart);
  EXPECT_NEAR(budget.workLeft(kStart), 1000.0, 1e-9) << "before anything is known";
  budget.measured(50.0, 0.1);
  EXPECT_NEAR(budget.workLeft(after(0.5)), 250.0, 1e-9);
  EXPECT_NEAR(budget.workLeft(after(5.0)), 10.0, 1e-9) << "a little always";
}

TEST(FrameBudget, keepsFewFramesInMind) {
  FrameBudget budget(1.0);
  for (int i = 1; i <= 100; ++i) budget.spentEarlier(ros::Time(i), 0.5, kStart);
  budget.begin(ros::Time(1.0), kStart);
  EXPECT_EQ(budget.spent(kStart), 0.0);
  budget.begin(ros::Time(100.0), kStart);
  EXPECT_EQ(budget.spent(kStart), 0.5);
}

}  // namespace
}  // namespace recognition
