#include <gtest/gtest.h>

#include <cmath>

#include "flight_corridor/range/lidar_watch.hpp"

namespace flight_corridor {
namespace {

RangeReading reading(double stamp_s, double range_m) { return {stamp_s, range_m, 0.2, 100.0, 0.01}; }

/// Believed readings of an approach, from one stamp to before another.
void feed(LidarWatch& watch, double from_s, double until_s, double rate_hz) {
  const int count = static_cast<int>(std::lround((until_s - from_s) * rate_hz));
  for (int i = 0; i < count; ++i) {
    const double stamp_s = from_s + i / rate_hz;
    watch.add(reading(stamp_s, 50.0 - stamp_s), true);
  }
}

TEST(LidarWatch, KnowsNothingBeforeTheFirstReading) {
  const LidarWatch watch;
  EXPECT_TRUE(std::isnan(watch.range(1.0, 0.5)));
  EXPECT_FALSE(watch.isRejected());
  EXPECT_FALSE(watch.isSlow(1.0));
  EXPECT_EQ(watch.beamWidth(), 0.0);
}

TEST(LidarWatch, OnlyMinusInfinitySaysTooCloseAndOnlyWhileItIsNew) {
  LidarWatch watch;
  EXPECT_FALSE(watch.isTooClose(1.0, 0.5));
  for (const double other_m : {kNaN, kInfinity, 0.0, 5.0}) {
    watch.add(reading(1.0, other_m), false);
    EXPECT_FALSE(watch.isTooClose(1.0, 0.5)) << other_m;
  }
  watch.add(reading(1.1, -kInfinity), false);
  EXPECT_TRUE(watch.isTooClose(1.2, 0.5));
  watch.add(reading(1.15, kNaN), false);
  EXPECT_TRUE(watch.isTooClose(1.2, 0.5)) << "a lost reading says nothing against it";
  EXPECT_FALSE(watch.isTooClose(1.7, 0.5));
  watch.add(reading(1.2, 5.0), true);
  EXPECT_FALSE(watch.isTooClose(1.2, 0.5));
}

TEST(LidarWatch, GivesTheNewestReadingUnlessItIsOldOrWasNotBelieved) {
  LidarWatch watch;
  watch.add(reading(1.0, 5.0), true);
  watch.add(reading(0.9, 6.0), true);  // late
  EXPECT_EQ(watch.range(1.2, 0.5), 5.0);
  EXPECT_TRUE(std::isnan(watch.range(1.6, 0.5)));
  watch.add(reading(1.1, 14.0), false);
  EXPECT_TRUE(std::isnan(watch.range(1.2, 0.5)));
  EXPECT_TRUE(watch.isRejected());
}

TEST(LidarWatch, ItsRangeIsValidWhileNothingButFartherSurfacesIsNotBelieved) {
  LidarWatch watch;
  EXPECT_FALSE(watch.hasValidRange(1.0, 0.5));
  watch.add(reading(1.0, 14.0), false);
  EXPECT_FALSE(watch.hasValidRange(1.0, 0.5));
  watch.add(reading(1.1, 5.0), true);
  for (const double farther_m : {14.0, kInfinity}) watch.add(reading(1.2, farther_m), false);
  EXPECT_TRUE(watch.hasValidRange(1.5, 0.5));
  EXPECT_FALSE(watch.hasValidRange(1.7, 0.5));
  for (const double other_m : {kNaN, -kInfinity, 0.0, 4.0}) {
    LidarWatch nearer = watch;
    nearer.add(reading(1.0, other_m), false);
    EXPECT_TRUE(nearer.hasValidRange(1.5, 0.5)) << other_m << " is late";
    nearer.add(reading(1.3, other_m), false);
    EXPECT_FALSE(nearer.hasValidRange(1.5, 0.5)) << other_m;
  }
}

TEST(LidarWatch, IsSilentUnlessAReadingIsBelieved) {
  LidarWatch watch;
  EXPECT_TRUE(watch.isSilent(1.0, 0.5));
  watch.add(reading(1.0, 5.0), true);
  for (double stamp_s = 1.1; stamp_s < 2.0; stamp_s += 0.1) {
    for (const double range_m : {kNaN, kInfinity, 0.0, 9509.0}) watch.add(reading(stamp_s, range_m), false);
    EXPECT_EQ(watch.isSilent(stamp_s, 0.55), stamp_s > 1.55) << stamp_s;
  }
  watch.add(reading(2.0, 5.0), true);
  EXPECT_FALSE(watch.isSilent(2.0, 0.5));
}

TEST(LidarWatch, NoticesWithinHalfASecondThatTheRateFell) {
  LidarWatch watch;
  feed(watch, 0.0, 2.0, 100.0);
  feed(watch, 2.0, 4.0, 5.0);
  for (double stamp_s = 2.5; stamp_s < 3.9; stamp_s += 0.1) EXPECT_TRUE(watch.isSlow(stamp_s)) << stamp_s;
  feed(watch, 4.0, 4.3, 100.0);
  EXPECT_FALSE(watch.isSlow(4.3));
}

TEST(LidarWatch, TakesNoSteadyRateForSlow) {
  for (const double rate_hz : {5.0, 10.0, 100.0, 1000.0}) {
    LidarWatch watch;
    feed(watch, 0.0, 3.0, rate_hz);
    for (double stamp_s = 2.8; stamp_s < 3.0 + 0.5 / rate_hz; stamp_s += 0.013) {
      EXPECT_FALSE(watch.isSlow(stamp_s)) << rate_hz << " Hz at " << stamp_s;
    }
  }
}

TEST(LidarWatch, TakesBurstsOfALinkForWhatTheyAre) {
  LidarWatch watch;
  for (int burst = 0; burst < 20; ++burst) {  // 100 Hz, ten at once
    for (int i = 0; i < 10; ++i) watch.add(reading(0.1 * burst + 0.0001 * i, 50.0 - burst - 0.1 * i), true);
    EXPECT_FALSE(watch.isSlow(0.1 * burst + 0.099)) << burst;
  }
}

TEST(LidarWatch, ForgetsABurstAtTheStart) {
  LidarWatch watch;
  for (int i = 0; i < 12; ++i) watch.add(reading(0.0001 * i, 50.0 - i), true);
  feed(watch, 0.1, 10.0, 10.0);
  EXPECT_FALSE(watch.isSlow(10.0));
}

}  // namespace
}  // namespace flight_corridor
