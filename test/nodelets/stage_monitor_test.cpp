// What a stage tells, and how often.
#include <gtest/gtest.h>

#include "ros/repeat_filter.h"
#include "ros/stage_monitor.h"

namespace recognition {
namespace {

std_msgs::Header header(double stamp, std::uint32_t seq = 0) {
  std_msgs::Header header;
  header.stamp = ros::Time(stamp);
  header.seq = seq;
  return header;
}

TEST(RepeatFilter, knowsWhatCameAMomentAgo) {
  RepeatFilter filter;
  const ros::WallTime now(100.0);
  const ros::WallDuration moment(0.01);
  EXPECT_FALSE(filter.isRepeat(header(1.0), now));
  EXPECT_TRUE(filter.isRepeat(header(1.0), now + moment));
  EXPECT_FALSE(filter.isRepeat(header(1.1), now + moment));
  EXPECT_FALSE(filter.isRepeat(header(1.1, 1), now + moment)) << "another message of the same stamp";
}

TEST(RepeatFilter, takesARecordingThatBeginsAgain) {
  RepeatFilter filter;
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(filter.isRepeat(header(1.0), ros::WallTime(100.0 + 0.2 * i)));
}

TEST(RepeatFilter, takesMessagesWithoutStamps) {
  RepeatFilter filter;
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(filter.isRepeat(header(0.0), ros::WallTime(100.0)));
}

TEST(StageMonitor, tellsALastingProblemEverMoreSeldom) {
  StageMonitor monitor;
  EXPECT_TRUE(monitor.rejected("topic", "stamps differ by 0.5 s"));
  EXPECT_FALSE(monitor.rejected("topic", "stamps differ by 0.7 s")) << "the same but for the number";
  EXPECT_TRUE(monitor.rejected("topic", "no depth")) << "another problem";
  EXPECT_TRUE(monitor.rejected("other topic", "no depth"));
  diagnostic_updater::DiagnosticStatusWrapper status;
  monitor.fill(status);
  EXPECT_EQ(status.message, "no depth [other topic]");
}

}  // namespace
}  // namespace recognition
