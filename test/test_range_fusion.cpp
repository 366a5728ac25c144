#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <random>
#include <vector>

#include "flight_corridor/range/range_fusion.hpp"

namespace {
std::atomic<int> allocations{0};
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace flight_corridor {
namespace {

constexpr double kLidarVariance_m2 = 0.02 * 0.02;
constexpr double kStereoVariance_m2 = 0.10 * 0.10;

struct Event {
  Sensor sensor;
  double stamp_s;
  double range_m;
  double variance_m2;
};

/// LiDAR at 100 Hz and stereo at 30 Hz on a surface that comes closer at a constant speed.
std::vector<Event> approach(unsigned seed, double start_m, double speed_mps, double duration_s) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  std::vector<Event> events;
  const auto add = [&](Sensor sensor, double rate_hz, double variance) {
    for (int i = 0; i / rate_hz < duration_s; ++i) {
      const double stamp = i / rate_hz;
      events.push_back({sensor, stamp, start_m - speed_mps * stamp + std::sqrt(variance) * noise(random), variance});
    }
  };
  add(Sensor::Lidar, 100.0, kLidarVariance_m2);
  add(Sensor::Stereo, 30.0, kStereoVariance_m2);
  std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.stamp_s < b.stamp_s; });
  return events;
}

Outcome feed(RangeFusion& fusion, const Event& event) {
  return fusion.add(event.sensor, event.stamp_s, event.range_m, event.variance_m2);
}

TEST(RangeFusion, WithoutDriftItIsTheWeightedMean) {
  FusionConfig config;
  config.acceleration_sigma_mps2 = 0.0;
  config.gate_sigma = kInfinity;
  RangeFusion fusion(config);
  // All readings at one stamp: no time for the rate to matter.
  double weighted = 0.0, weights = 0.0;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(5.0, 0.1);
  for (int i = 0; i < 40; ++i) {
    const double variance = i % 2 ? kLidarVariance_m2 : kStereoVariance_m2, range = noise(random);
    fusion.add(i % 2 ? Sensor::Lidar : Sensor::Stereo, 1.0, range, variance);
    weighted += range / variance;
    weights += 1.0 / variance;
  }
  EXPECT_NEAR(fusion.at(1.0).range_m, weighted / weights, 1e-9);
  EXPECT_NEAR(fusion.at(1.0).sigma_m, std::sqrt(1.0 / weights), 1e-9);
}

TEST(RangeFusion, AnyOrderOfArrivalGivesTheSameState) {
  const std::vector<Event> events = approach(7, 5.0, 1.0, 0.4);  // within the buffer
  RangeFusion in_order((FusionConfig()));
  for (const Event& event : events) feed(in_order, event);
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::vector<Event> shuffled = events;
    std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(seed));
    RangeFusion fusion((FusionConfig()));
    for (const Event& event : shuffled) feed(fusion, event);
    EXPECT_EQ(fusion.at(0.5).range_m, in_order.at(0.5).range_m) << "shuffle " << seed;
    EXPECT_EQ(fusion.at(0.5).rate_mps, in_order.at(0.5).rate_mps) << "shuffle " << seed;
  }
}

TEST(RangeFusion, TrueRangeLiesWithinTwoSigmaAboutNinetyFivePercentOfTheTime) {
  int inside = 0, all = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    RangeFusion fusion((FusionConfig()));
    for (const Event& event : approach(seed, 6.0, 1.5, 2.0)) {
      feed(fusion, event);
      if (event.stamp_s < 0.5) continue;  // the rate is being learnt
      const RangeEstimate estimate = fusion.at(event.stamp_s);
      inside += std::abs(estimate.range_m - (6.0 - 1.5 * event.stamp_s)) <= 2.0 * estimate.sigma_m;
      ++all;
    }
  }
  // A constant speed is calmer than the white acceleration that the filter allows for: never fewer than 95 % (- 2 %
  // for 40 runs of correlated errors).
  EXPECT_GT(inside / static_cast<double>(all), 0.93);
}

TEST(RangeFusion, ForgetsAfterTheGap) {
  RangeFusion fusion((FusionConfig()));
  fusion.add(Sensor::Lidar, 1.0, 5.0, kLidarVariance_m2);
  fusion.add(Sensor::Lidar, 1.0, 5.0, kLidarVariance_m2);
  EXPECT_NEAR(fusion.at(1.4).range_m, 5.0, 1e-9);
  EXPECT_TRUE(std::isnan(fusion.at(1.6).range_m));
  EXPECT_EQ(fusion.add(Sensor::Lidar, 2.0, 9.0, kLidarVariance_m2), Outcome::Reinitialised);
}

TEST(RangeFusion, TheRigsAccelerationIsFollowedWithoutLag) {
  // Standing still, then 2 m/s^2 towards a wall for 1 s; a reading every 0.1 s, accelerations at 100 Hz.
  const auto range = [](double t) { return 8.0 - std::pow(std::max(0.0, t - 1.0), 2); };
  const auto largest_error = [&](bool has_imu) {
    RangeFusion fusion((FusionConfig()));
    double largest_m = 0.0;
    for (int i = 0; i < 200; ++i) {
      const double stamp = 0.01 * i;
      if (has_imu) fusion.addAcceleration(stamp, i < 100 ? 0.0 : 2.0);
      if (i > 0 && i % 10 == 0) {
        largest_m = std::max(largest_m, std::abs(fusion.at(stamp).range_m - range(stamp)));
      }
      if (i % 10 == 0) fusion.add(Sensor::Lidar, stamp, range(stamp), kLidarVariance_m2);
      if (i == 0) fusion.add(Sensor::Lidar, stamp, range(stamp), kLidarVariance_m2);
    }
    return largest_m;
  };
  EXPECT_LT(largest_error(true), 1e-3);   // what remains is rounding
  EXPECT_GT(largest_error(false), 0.01);  // dt^2 of the first unforeseen interval
}

TEST(RangeFusion, AnOldAccelerationNoLongerDrives) {
  RangeFusion fusion((FusionConfig()));
  fusion.add(Sensor::Lidar, 1.0, 5.0, kLidarVariance_m2);
  fusion.add(Sensor::Lidar, 1.0, 5.0, kLidarVariance_m2);
  fusion.addAcceleration(1.0, 9.0);
  EXPECT_LT(fusion.at(1.05).rate_mps, -0.4);
  EXPECT_EQ(fusion.at(1.2).rate_mps, 0.0);
}

TEST(RangeFusion, AccelerationsMayComeLateToo) {
  RangeFusion in_order((FusionConfig())), late((FusionConfig()));
  for (RangeFusion* fusion : {&in_order, &late}) fusion->add(Sensor::Lidar, 1.0, 5.0, kLidarVariance_m2);
  in_order.addAcceleration(1.01, 3.0);
  in_order.add(Sensor::Stereo, 1.05, 4.99, kStereoVariance_m2);
  late.add(Sensor::Stereo, 1.05, 4.99, kStereoVariance_m2);
  late.addAcceleration(1.01, 3.0);
  EXPECT_EQ(in_order.at(1.06).range_m, late.at(1.06).range_m);
  EXPECT_EQ(in_order.at(1.06).rate_mps, late.at(1.06).rate_mps);
}

TEST(RangeFusion, AccelerationsAloneAreNoRange) {
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 100; ++i) EXPECT_EQ(fusion.addAcceleration(0.01 * i, 1.0), Outcome::Accepted);
  EXPECT_EQ(fusion.addAcceleration(1.0, kNaN), Outcome::Invalid);
  EXPECT_EQ(fusion.addAcceleration(kNaN, 1.0), Outcome::Invalid);
  EXPECT_TRUE(std::isnan(fusion.at(1.0).range_m));
}

TEST(RangeFusion, AnHourOfReadingsChangesNothingOfTheirFusion) {
  RangeFusion flown((FusionConfig())), fresh((FusionConfig()));
  for (int i = 0; i < 360000; ++i) {
    flown.add(Sensor::Lidar, 0.01 * i, 5.0, kLidarVariance_m2);
    if (i >= 359000) fresh.add(Sensor::Lidar, 0.01 * i, 5.0, kLidarVariance_m2);
  }
  EXPECT_NEAR(flown.at(3600.0).range_m, fresh.at(3600.0).range_m, 1e-9);
  EXPECT_NEAR(flown.at(3600.0).sigma_m, fresh.at(3600.0).sigma_m, 1e-9);
}

TEST(RangeFusion, MoreReadingsThanTheBufferHoldsAreFusedAllTheSame) {
  RangeFusion fusion((FusionConfig()));  // 5 kHz: the buffer's half second does not fit
  for (int i = 0; i < 20000; ++i) {
    ASSERT_NE(fusion.add(Sensor::Lidar, 2e-4 * i, 5.0 + 1e-3 * (i % 2), kLidarVariance_m2), Outcome::TooLate) << i;
  }
  EXPECT_NEAR(fusion.at(4.0).range_m, 5.0, 0.01);
}

TEST(RangeFusion, NothingIsAllocatedInFlight) {
  RangeFusion fusion((FusionConfig()));
  const int before = allocations;
  for (int i = 0; i < 3000; ++i) {
    fusion.addAcceleration(0.01 * i, 0.1);
    fusion.add(Sensor::Lidar, 0.01 * i, 5.0, kLidarVariance_m2);
    if (i % 3 == 0) fusion.add(Sensor::Stereo, 0.01 * i - 0.1, 5.0, kStereoVariance_m2);
  }
  EXPECT_EQ(allocations, before);
}

TEST(RangeFusion, RefusesWhatIsNoReading) {
  RangeFusion fusion((FusionConfig()));
  for (const double range : {kNaN, kInfinity, -kInfinity, 0.0, -1.0}) {
    EXPECT_EQ(fusion.add(Sensor::Lidar, 1.0, range, kLidarVariance_m2), Outcome::Invalid) << range;
  }
  EXPECT_EQ(fusion.add(Sensor::Lidar, kNaN, 5.0, kLidarVariance_m2), Outcome::Invalid);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 1.0, 5.0, 0.0), Outcome::Invalid);
  EXPECT_TRUE(std::isnan(fusion.at(1.0).range_m));
}

TEST(RangeFusion, ReadingsOlderThanTheBufferAreTooLate) {
  RangeFusion fusion((FusionConfig()));
  fusion.add(Sensor::Lidar, 2.0, 5.0, kLidarVariance_m2);
  EXPECT_EQ(fusion.add(Sensor::Stereo, 1.4, 5.0, kStereoVariance_m2), Outcome::TooLate);
}

}  // namespace
}  // namespace flight_corridor
