#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "camera/openni2_stamp_filter.h"

namespace recognition {
namespace {

constexpr double kStart = 1.6e9;  // the computer's time when the device's clock was 0, s
constexpr double kDelay = 0.012;  // smallest delay, s
constexpr uint64_t kPeriod = 33333;

TEST(StampFilter, IsExactWithoutJitter) {
  StampFilter filter;
  for (uint64_t t = 0; t < 100 * kPeriod; t += kPeriod) {
    EXPECT_NEAR(kStart + 1e-6 * t + kDelay, filter.stamp(t, kStart + 1e-6 * t + kDelay), 1e-6);
  }
}

TEST(StampFilter, TakesTheJitterOutOfArrivals) {
  std::mt19937 random(1);
  std::exponential_distribution<double> jitter(1.0 / 0.008);
  StampFilter filter;
  double last = 0.0, worst_spacing = 0.0, worst_error = 0.0;
  for (int frame = 0; frame < 3000; ++frame) {
    const uint64_t t = frame * kPeriod;
    const double stamp = filter.stamp(t, kStart + 1e-6 * t + kDelay + jitter(random));
    if (frame > 300) {
      worst_spacing = std::max(worst_spacing, std::abs(stamp - last - 1e-6 * kPeriod));
      worst_error = std::max(worst_error, std::abs(stamp - (kStart + 1e-6 * t + kDelay)));
    }
    last = stamp;
  }
  EXPECT_LT(worst_spacing, 0.0012);  // arrivals themselves: 50 ms
  EXPECT_LT(worst_error, 0.0015);
}

TEST(StampFilter, FollowsClocksThatDriftApart) {
  for (const double drift : {-5e-5, 5e-5}) {
    StampFilter filter;
    double stamp = 0.0, truth = 0.0;
    for (int frame = 0; frame < 18000; ++frame) {  // ten minutes
      const uint64_t t = frame * kPeriod;
      truth = kStart + 1e-6 * t * (1.0 + drift) + kDelay;
      stamp = filter.stamp(t, truth + (frame % 10 == 0 ? 0.0 : 0.01));
    }
    EXPECT_NEAR(truth, stamp, 1e-4) << drift;
  }
}

TEST(StampFilter, EqualDeviceStampsGiveEqualStamps) {
  StampFilter filter;
  const double color = filter.stamp(0, kStart + 0.020);
  EXPECT_EQ(color, filter.stamp(0, kStart + 0.012));
  const double second_depth = filter.stamp(kPeriod, kStart + 0.050);
  EXPECT_EQ(second_depth, filter.stamp(kPeriod, kStart + 0.060));
}

TEST(StampFilter, StartsAnewWhenAClockWasSet) {
  StampFilter filter;
  for (uint64_t t = 0; t < 100 * kPeriod; t += kPeriod) filter.stamp(t, kStart + 1e-6 * t);
  EXPECT_DOUBLE_EQ(kStart + 500.0, filter.stamp(0, kStart + 500.0));
  EXPECT_DOUBLE_EQ(kStart - 500.0, filter.stamp(kPeriod, kStart - 500.0));
}

}  // namespace
}  // namespace recognition
