#include <gtest/gtest.h>

#include "camera/openni2_statistics.h"

namespace recognition {
namespace {

constexpr double kRate = 30.0;
uint64_t stampOf(int frame) { return frame * 1000000ull / 30; }

TEST(StreamStatistics, CountsFramesAndThoseThatAreMissing) {
  StreamStatistics statistics;
  statistics.restart(100.0, kRate);
  for (const int frame : {40, 41, 44, 45}) statistics.count(stampOf(frame), 100.0 + frame / 30.0);
  const StreamStatistics::Report report = statistics.report(102.0);
  EXPECT_EQ(4, report.frames);
  EXPECT_EQ(2, report.dropped);
  EXPECT_DOUBLE_EQ(2.0, report.rate);
  EXPECT_DOUBLE_EQ(0.5, report.silence);
}

TEST(StreamStatistics, RateIsThatSinceTheLastReport) {
  StreamStatistics statistics;
  statistics.restart(0.0, kRate);
  for (int i = 1; i <= 30; ++i) statistics.count(stampOf(i), i / 30.0);
  statistics.report(1.0);
  for (int i = 31; i <= 45; ++i) statistics.count(stampOf(i), i / 30.0);
  EXPECT_DOUBLE_EQ(15.0, statistics.report(2.0).rate);
}

TEST(StreamStatistics, AClockThatIsSetLosesNothing) {
  StreamStatistics statistics;
  statistics.restart(0.0, kRate);
  for (const int frame : {500, 1, 2, 90000}) statistics.count(stampOf(frame), 0.1);
  EXPECT_EQ(0, statistics.report(1.0).dropped);
}

TEST(StreamStatistics, SlowerStreamsLoseWhatIsTheirs) {
  StreamStatistics statistics;
  statistics.restart(0.0, 15.0);
  for (const int frame : {10, 12, 14, 18}) statistics.count(stampOf(frame), 0.1);
  EXPECT_EQ(1, statistics.report(1.0).dropped);
}

TEST(StreamStatistics, SilenceBeginsWithTheStart) {
  StreamStatistics statistics;
  statistics.restart(10.0, kRate);
  EXPECT_DOUBLE_EQ(3.0, statistics.silence(13.0));
  statistics.count(stampOf(1), 14.0);
  EXPECT_DOUBLE_EQ(1.0, statistics.silence(15.0));
}

}  // namespace
}  // namespace recognition
