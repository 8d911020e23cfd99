#include <gtest/gtest.h>

#include "ros/frame_budget.h"

namespace recognition {
namespace {

const ros::WallTime kStart(1000.0);
ros::WallTime after(double seconds) { return kStart + ros::WallDuration(seconds); }

TEST(FrameBudget, withoutLimitAllIsAffordable) {
  FrameBudget budget;
  budget.begin(ros::Time(1.0), kStart);
  budget.tested(10, 1.0);
  EXPECT_EQ(budget.affordable(500, after(100.0)), 500u);
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

TEST(FrameBudget, affordsWhatFitsTheTimeLeft) {
  FrameBudget budget(1.0);
  budget.begin(ros::Time(1.0), kStart);
  EXPECT_EQ(budget.affordable(100, kStart), 100u) << "before anything is known";
  budget.tested(10, 0.1);
  EXPECT_EQ(budget.affordable(100, after(0.5)), 50u);
  EXPECT_EQ(budget.affordable(20, after(0.5)), 20u);
  EXPECT_EQ(budget.affordable(100, after(5.0)), 10u) << "a few always";
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
