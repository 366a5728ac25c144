#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "flight_corridor/range_fusion.hpp"

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

TEST(RangeFusion, OneSensorJumpingAloneIsGated) {
  RangeFusion fusion((FusionConfig()));
  for (const Event& event : approach(1, 5.0, 0.0, 0.5)) feed(fusion, event);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.51, 14.0, kLidarVariance_m2), Outcome::Gated);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.52, 1.0, kLidarVariance_m2), Outcome::Gated);
  EXPECT_NEAR(fusion.at(0.52).range_m, 5.0, 4 * std::sqrt(kLidarVariance_m2));
}

TEST(RangeFusion, ReinitialisesWhenBothSensorsJumpTogether) {
  RangeFusion fusion((FusionConfig()));
  for (const Event& event : approach(1, 6.0, 0.0, 0.5)) feed(fusion, event);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.51, 2.0, kLidarVariance_m2), Outcome::Gated);
  EXPECT_EQ(fusion.add(Sensor::Stereo, 0.52, 2.05, kStereoVariance_m2), Outcome::Reinitialised);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.53, 2.0, kLidarVariance_m2), Outcome::Accepted);
  EXPECT_NEAR(fusion.at(0.53).range_m, 2.0, 4 * std::sqrt(kLidarVariance_m2));
}

TEST(RangeFusion, InLastingDisagreementTheNearerSensorRules) {
  for (const bool lidar_is_wrong : {true, false}) {
    RangeFusion fusion((FusionConfig()));
    for (int i = 0; i < 100; ++i) {
      const double stamp = 0.01 * i;
      fusion.add(Sensor::Lidar, stamp, lidar_is_wrong ? 12.0 : 3.0, kLidarVariance_m2);
      if (i % 3 == 0) fusion.add(Sensor::Stereo, stamp, lidar_is_wrong ? 3.0 : 12.0, kStereoVariance_m2);
    }
    const RangeEstimate estimate = fusion.at(1.0);
    EXPECT_TRUE(estimate.disagreement);
    EXPECT_NEAR(estimate.range_m, 3.0, 0.2);
    EXPECT_NEAR(estimate.disagreeing_m, 12.0, 1e-9);
  }
}

TEST(RangeFusion, ForgetsAfterTheGap) {
  RangeFusion fusion((FusionConfig()));
  fusion.add(Sensor::Lidar, 1.0, 5.0, kLidarVariance_m2);
  fusion.add(Sensor::Lidar, 1.0, 5.0, kLidarVariance_m2);
  EXPECT_NEAR(fusion.at(1.4).range_m, 5.0, 1e-9);
  EXPECT_TRUE(std::isnan(fusion.at(1.6).range_m));
  EXPECT_EQ(fusion.add(Sensor::Lidar, 2.0, 9.0, kLidarVariance_m2), Outcome::Reinitialised);
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

TEST(RangeFusion, ALoneReadingIsNoRangeUntilASecondConfirmsIt) {
  RangeFusion fusion((FusionConfig()));
  fusion.add(Sensor::Lidar, 1.0, 1.5, kLidarVariance_m2);  // a spike into open sky
  EXPECT_TRUE(std::isnan(fusion.at(1.0).range_m));
  fusion.add(Sensor::Lidar, 1.01, 7.0, kLidarVariance_m2);
  EXPECT_TRUE(std::isnan(fusion.at(1.01).range_m));
  fusion.add(Sensor::Stereo, 1.02, 7.05, kStereoVariance_m2);
  EXPECT_NEAR(fusion.at(1.02).range_m, 7.0, 0.1);
}

TEST(RangeFusion, ReadingsOlderThanTheBufferAreTooLate) {
  RangeFusion fusion((FusionConfig()));
  fusion.add(Sensor::Lidar, 2.0, 5.0, kLidarVariance_m2);
  EXPECT_EQ(fusion.add(Sensor::Stereo, 1.4, 5.0, kStereoVariance_m2), Outcome::TooLate);
}

}  // namespace
}  // namespace flight_corridor
