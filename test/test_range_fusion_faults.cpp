#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "flight_corridor/range/range_fusion.hpp"

// Sensors that differ, jump, or hang.

namespace flight_corridor {
namespace {

bool stereoDisagrees(const RangeEstimate& estimate) {
  return estimate.disagreement && estimate.disagreement->sensor == Sensor::Stereo;
}

constexpr double kLidarVariance_m2 = 0.02 * 0.02;
constexpr double kStereoVariance_m2 = 0.10 * 0.10;

/// Half a second of both sensors on a surface at rest.
void settle(RangeFusion& fusion, double range_m) {
  for (int i = 0; i < 50; ++i) {
    fusion.add(Sensor::Lidar, 0.01 * i, range_m + 0.01 * (i % 3 - 1), kLidarVariance_m2);
    if (i % 3 == 0) fusion.add(Sensor::Stereo, 0.01 * i, range_m + 0.05 * (i % 2), kStereoVariance_m2);
  }
}

TEST(RangeFusionFaults, TwoSensorsThatDifferOnANewSurfaceAreNoSpeed) {
  RangeFusion fusion((FusionConfig()));
  double now_s = 0.0;
  for (; now_s < 1.0; now_s += 0.01) fusion.add(Sensor::Lidar, now_s, 10.0 - now_s, kLidarVariance_m2);
  fusion.add(Sensor::Lidar, now_s, 4.12, kLidarVariance_m2);
  ASSERT_EQ(fusion.add(Sensor::Stereo, now_s, 4.35, kStereoVariance_m2), Outcome::Reinitialised);
  fusion.add(Sensor::Lidar, now_s + 0.01, 4.11, kLidarVariance_m2);
  fusion.add(Sensor::Lidar, now_s + 0.02, 4.11, kLidarVariance_m2);
  EXPECT_NEAR(fusion.at(now_s + 0.02).rate_mps, -1.0, 0.8);
}

TEST(RangeFusionFaults, OneSensorJumpingAloneIsGated) {
  RangeFusion fusion((FusionConfig()));
  settle(fusion, 5.0);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.51, 14.0, kLidarVariance_m2), Outcome::Gated);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.52, 1.0, kLidarVariance_m2), Outcome::Gated);
  EXPECT_NEAR(fusion.at(0.52).range_m, 5.0, 4 * std::sqrt(kLidarVariance_m2));
}

TEST(RangeFusionFaults, ReinitialisesWhenBothSensorsJumpTogether) {
  RangeFusion fusion((FusionConfig()));
  settle(fusion, 6.0);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.51, 2.0, kLidarVariance_m2), Outcome::Gated);
  EXPECT_EQ(fusion.add(Sensor::Stereo, 0.52, 2.05, kStereoVariance_m2), Outcome::Reinitialised);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.53, 2.0, kLidarVariance_m2), Outcome::Accepted);
  EXPECT_NEAR(fusion.at(0.53).range_m, 2.0, 4 * std::sqrt(kLidarVariance_m2));
}

TEST(RangeFusionFaults, InLastingDisagreementTheNearerSensorRules) {
  for (const bool lidar_is_wrong : {true, false}) {
    RangeFusion fusion((FusionConfig()));
    for (int i = 0; i < 100; ++i) {
      const double stamp = 0.01 * i;
      fusion.add(Sensor::Lidar, stamp, lidar_is_wrong ? 12.0 : 3.0, kLidarVariance_m2);
      if (i % 3 == 0) fusion.add(Sensor::Stereo, stamp, lidar_is_wrong ? 3.0 : 12.0, kStereoVariance_m2);
    }
    const RangeEstimate estimate = fusion.at(1.0);
    ASSERT_TRUE(estimate.disagreement);
    EXPECT_NEAR(estimate.range_m, 3.0, 0.2);
    EXPECT_NEAR(estimate.disagreement->range_m, 12.0, 1e-9);
    EXPECT_EQ(stereoDisagrees(estimate), !lidar_is_wrong);
  }
}

TEST(RangeFusionFaults, WhatIsTheSameInAllReadingsCountsBetweenTheSensorsAlone) {
  constexpr double kCommon_1pm = 0.01;  // at 30 m and 22 m: 6.6 m
  for (const bool is_known : {true, false}) {
    RangeFusion fusion((FusionConfig()));
    for (int i = 0; i < 100; ++i) {
      if (i % 3 == 0) fusion.add(Sensor::Stereo, 0.01 * i, 22.0, kStereoVariance_m2, is_known ? kCommon_1pm : 0.0);
      if (i >= 30) fusion.add(Sensor::Lidar, 0.01 * i, 29.7 + 0.001 * (i % 2), kLidarVariance_m2);
    }
    EXPECT_EQ(fusion.at(1.0).disagreement.has_value(), !is_known);
    EXPECT_NEAR(fusion.at(1.0).range_m, is_known ? 29.7 : 22.0, 0.3) << "d_K is the LiDAR's";
    EXPECT_EQ(fusion.add(Sensor::Stereo, 1.01, 8.0, kStereoVariance_m2, kCommon_1pm), Outcome::Gated);
  }
}

TEST(RangeFusionFaults, ARangeIsNotNegativeWhenASurfaceHasBeenPassed) {
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 20; ++i) fusion.add(Sensor::Lidar, 0.01 * i, 1.0 - 0.05 * i + 0.05, kLidarVariance_m2);
  EXPECT_EQ(fusion.at(0.4).range_m, 0.0) << "at 5 m/s";
}

/// Half a second of a LiDAR that is farther than stereo, which rules.
void settleFarther(RangeFusion& fusion, double lidar_m, double stereo_m) {
  for (int i = 0; i < 60; ++i) {
    fusion.add(Sensor::Lidar, 0.01 * i, lidar_m + 0.001 * (i % 2), kLidarVariance_m2);
    if (i % 3 == 0) fusion.add(Sensor::Stereo, 0.01 * i, stereo_m, kStereoVariance_m2);
  }
}

TEST(RangeFusionFaults, ALoneNearerReadingOfASensorInLastingDisagreementIsPassedOver) {
  RangeFusion fusion((FusionConfig()));
  settleFarther(fusion, 14.0, 10.0);
  ASSERT_TRUE(fusion.at(0.6).disagreement.has_value());
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.6, 6.0, kLidarVariance_m2), Outcome::Gated) << "14 m lasted, not 6 m";
  EXPECT_NEAR(fusion.at(0.6).range_m, 10.0, 0.2);
}

TEST(RangeFusionFaults, TwoNearerReadingsOfASensorInLastingDisagreementRuleThoughOthersCameBetween) {
  for (const int others : {0, 1, 2}) {
    RangeFusion fusion((FusionConfig()));
    settleFarther(fusion, 14.0, 10.0);
    ASSERT_EQ(fusion.add(Sensor::Lidar, 0.6, 6.0, kLidarVariance_m2), Outcome::Gated);
    for (int i = 0; i < others; ++i) fusion.add(Sensor::Lidar, 0.61 + 0.01 * i, 14.0, kLidarVariance_m2);
    EXPECT_EQ(fusion.add(Sensor::Lidar, 0.64, 6.0, kLidarVariance_m2), Outcome::Reinitialised) << others;
    EXPECT_NEAR(fusion.at(0.64).range_m, 6.0, 0.1) << others;
  }
}

TEST(RangeFusionFaults, AStereoPeakDoesNotEndItsDisagreementWithANearerLidarWhateverCameBefore) {
  RangeFusion fusion((FusionConfig()));
  settle(fusion, 10.0);
  fusion.add(Sensor::Stereo, 0.50, 14.0, kStereoVariance_m2);
  fusion.add(Sensor::Stereo, 0.51, 20.0, kStereoVariance_m2);  // ignored as an outlier
  ASSERT_EQ(fusion.add(Sensor::Stereo, 0.52, 10.0, kStereoVariance_m2), Outcome::Accepted);
  double stamp = 0.52;
  for (int i = 0; i < 30; ++i, stamp += 0.01) {
    fusion.add(Sensor::Lidar, stamp, 6.0 + 0.001 * (i % 2), kLidarVariance_m2);
  }
  ASSERT_TRUE(stereoDisagrees(fusion.at(stamp)));
  EXPECT_EQ(fusion.add(Sensor::Stereo, stamp, 20.0, kStereoVariance_m2), Outcome::Gated);
  EXPECT_TRUE(stereoDisagrees(fusion.at(stamp)));
}

TEST(RangeFusionFaults, StereoThatANearerLidarContradictsDisagreesHoweverLateItsReadingsAre) {
  constexpr double kLate_s = 0.2;
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 20; ++i) {  // at 4 m/s; stereo at 4 Hz measures a quarter too much
    const double stamp = 1.0 + 0.05 * i, true_m = 9.0 - 4.0 * (stamp - 1.0);
    fusion.add(Sensor::Lidar, stamp - kLate_s, true_m + 4.0 * kLate_s, kLidarVariance_m2);
    if (i % 5 != 0) continue;
    fusion.add(Sensor::Stereo, stamp, 1.25 * true_m, kStereoVariance_m2);
    if (i < 10) continue;  // 0.2 s are lasting
    EXPECT_TRUE(stereoDisagrees(fusion.at(stamp))) << stamp;
    EXPECT_NEAR(fusion.at(stamp).range_m, true_m, 0.3) << stamp;
  }
}

TEST(RangeFusionFaults, SensorsThatDifferTakeNoTurnsHoweverSlowOneIs) {
  for (const bool lidar_is_slow : {true, false}) {
    RangeFusion fusion((FusionConfig()));
    for (int i = 0; i < 200; ++i) {  // one at 100 Hz, one at 3 Hz; the nearer one rules
      const double stamp = 0.01 * i;
      const bool slow_too = i % 33 == 0;
      if (slow_too || !lidar_is_slow) fusion.add(Sensor::Lidar, stamp, lidar_is_slow ? 5.0 : 14.0, kLidarVariance_m2);
      if (slow_too || lidar_is_slow) fusion.add(Sensor::Stereo, stamp, 7.0, kStereoVariance_m2);
      if (i < 100) continue;
      EXPECT_TRUE(fusion.at(stamp).disagreement.has_value()) << stamp;
      EXPECT_EQ(stereoDisagrees(fusion.at(stamp)), lidar_is_slow) << stamp;
      EXPECT_NEAR(fusion.at(stamp).range_m, lidar_is_slow ? 5.0 : 7.0, 0.2) << stamp;
    }
  }
}

/// Range of two sensors that see one wall at rest each at its own place, from 3 s to 8 s.
struct Extremes {
  double least_m = kInfinity, most_m = -kInfinity;
  int frames = 0, noticed = 0;  // of disagreement
};

Extremes atRest(double lidar_hz, double lidar_m, double stereo_hz, double stereo_m, double stereo_later_s) {
  RangeFusion fusion((FusionConfig()));
  Extremes extremes;
  int lidar_readings = 0, stereo_readings = 0;
  while (true) {
    const double lidar_s = lidar_readings / lidar_hz, stereo_s = stereo_readings / stereo_hz + stereo_later_s;
    const double stamp = std::min(lidar_s, stereo_s);
    if (stamp > 8.0) return extremes;
    if (lidar_s <= stereo_s) {
      fusion.add(Sensor::Lidar, stamp, lidar_m + 0.01 * (lidar_readings++ % 3 - 1), kLidarVariance_m2);
    } else {
      fusion.add(Sensor::Stereo, stamp, stereo_m + 0.03 * (stereo_readings++ % 3 - 1), kStereoVariance_m2);
    }
    const RangeEstimate estimate = fusion.at(stamp);
    if (stamp < 3.0) continue;
    extremes.least_m = std::fmin(extremes.least_m, estimate.range_m);
    extremes.most_m = std::isnan(estimate.range_m) ? kInfinity : std::max(extremes.most_m, estimate.range_m);
    ++extremes.frames;
    extremes.noticed += estimate.disagreement.has_value();
  }
}

TEST(RangeFusionFaults, SensorsThatAlternateAndDifferAreDistinguished) {
  for (const double rate_hz : {10.0, 20.0}) {
    for (const double later_s : {0.008, 0.5 / rate_hz, 1.0 / rate_hz - 0.008}) {
      const Extremes extremes = atRest(rate_hz, 3.5, rate_hz, 5.0, later_s);
      EXPECT_EQ(extremes.noticed, extremes.frames) << rate_hz << " Hz, " << later_s << " s";
      EXPECT_NEAR(extremes.most_m, 3.5, 0.2) << rate_hz << " Hz, " << later_s << " s";
    }
  }
}

TEST(RangeFusionFaults, ARateThatTwoDifferingSensorsFeignDoesNotRunAway) {
  for (double later_s = 0.01; later_s < 0.25; later_s += 0.01) {
    const Extremes extremes = atRest(7.0, 3.0, 4.0, 3.75, later_s);
    EXPECT_GT(extremes.least_m, 2.5) << later_s;
    EXPECT_LT(extremes.most_m, 4.25) << later_s;
  }
}

TEST(RangeFusionFaults, ALoneOutlierOfASlowLidarIsNoDisagreement) {
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 200; ++i) {  // at 4 Hz: nothing of the LiDAR's was accepted for half a second then
    const double stamp = 0.01 * i;
    if (i % 25 == 0) fusion.add(Sensor::Lidar, stamp, i == 100 ? 2.0 : 5.0 + 0.01 * (i % 2), kLidarVariance_m2);
    if (i % 10 == 0) fusion.add(Sensor::Stereo, stamp, 5.0, kStereoVariance_m2);
    EXPECT_FALSE(fusion.at(stamp).disagreement.has_value()) << stamp;
  }
}

/// The wall behind, as stereo sees it, which the LiDAR meets in every fifth reading.
TEST(RangeFusionFaults, ALoneFartherReadingOfTheLidarDoesNotLeaveWhatItSeesNearer) {
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 200; ++i) {
    const double stamp = 0.05 * i;
    fusion.add(Sensor::Lidar, stamp, i % 5 == 2 ? 8.0 : 3.0, kLidarVariance_m2);
    if (i % 2 == 0) fusion.add(Sensor::Stereo, stamp, 8.0, kStereoVariance_m2);
    if (stamp <= 1.0) continue;
    EXPECT_NEAR(fusion.at(stamp).range_m, 3.0, 0.2) << stamp;
  }
}

TEST(RangeFusionFaults, OutliersOfTheLidarDoNotHideANewSurfaceOfStereos) {
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 150; ++i) {  // 50 Hz, and stereo at 10 Hz, which comes to see 3 m
    const double stamp = 0.02 * i;
    const bool is_outlier = stamp > 1.0 && i % 5 != 0 && i % 5 < 3;
    fusion.add(Sensor::Lidar, stamp, is_outlier ? 1.0 + 0.7 * (i % 11) + 10.0 : 6.0, kLidarVariance_m2);
    if (i % 5 == 0) fusion.add(Sensor::Stereo, stamp, stamp < 1.0 ? 6.0 : 3.0, kStereoVariance_m2);
    if (stamp <= 1.5) continue;
    EXPECT_NEAR(fusion.at(stamp).range_m, 3.0, 0.3) << stamp;
  }
}

TEST(RangeFusionFaults, TwoReadingsInOneMomentAreNotPersistent) {
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i <= 10; ++i) fusion.add(Sensor::Stereo, 0.1 * i, 6.0, kStereoVariance_m2);
  fusion.add(Sensor::Lidar, 1.01, 3.0, kLidarVariance_m2);
  fusion.add(Sensor::Lidar, 1.02, 3.0, kLidarVariance_m2);
  EXPECT_NEAR(fusion.at(1.02).range_m, 6.0, 0.2);
  EXPECT_FALSE(fusion.at(1.02).disagreement.has_value());
}

TEST(RangeFusionFaults, ASlowCameraTooRulesWhenItIsNearer) {
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 200; ++i) {  // a LiDAR 9 m off while stereo, at 5 Hz, saw nothing for a while
    const double stamp = 0.01 * i;
    fusion.add(Sensor::Lidar, stamp, 12.0 - stamp, kLidarVariance_m2);
    if (i >= 100 && i % 20 == 0) fusion.add(Sensor::Stereo, stamp, 3.0 - stamp, kStereoVariance_m2);
  }
  EXPECT_NEAR(fusion.at(2.0).range_m, 1.2, 0.3);
  EXPECT_TRUE(fusion.at(2.0).disagreement.has_value());
}

TEST(RangeFusionFaults, ALidarThatRepeatsItselfWhileStereoMovesIsFrozen) {
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 150; ++i) {  // flying away from a wall at 2 m/s; the LiDAR hangs after half a second
    const double stamp = 0.01 * i, true_m = 3.0 + 2.0 * stamp;
    const double noise_m = 0.001 * (i % 3);
    fusion.add(Sensor::Lidar, stamp, i < 50 ? true_m + noise_m : 4.0, kLidarVariance_m2);
    if (i % 3 == 0) fusion.add(Sensor::Stereo, stamp, true_m, kStereoVariance_m2);
  }
  EXPECT_NEAR(fusion.at(1.5).range_m, 6.0, 0.2);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 1.5, 4.0, kLidarVariance_m2), Outcome::Gated);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 1.51, 6.02, kLidarVariance_m2), Outcome::Accepted);
}

TEST(RangeFusionFaults, ALidarThatStopsAtOnceInFlightIsFrozen) {
  // The rate of 1 m/s is known to 0.6 m/s, so four sigma of the LiDAR, 0.08 m, are travelled within 0.2 s; a little
  // more for the rate's own error. Stereo is not asked.
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 134; ++i) {
    const double stamp = 0.01 * i, noise_m = 0.001 * (i % 3);
    fusion.add(Sensor::Lidar, stamp, i < 100 ? 8.0 - stamp + noise_m : 7.0, kLidarVariance_m2);
  }
  EXPECT_EQ(fusion.add(Sensor::Lidar, 1.34, 7.0, kLidarVariance_m2), Outcome::Gated);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 1.35, 6.98, kLidarVariance_m2), Outcome::Accepted);
}

TEST(RangeFusionFaults, ALidarThatRepeatsItselfWhileNothingMovesIsNot) {
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 150; ++i) {
    EXPECT_NE(fusion.add(Sensor::Lidar, 0.01 * i, 4.0, kLidarVariance_m2), Outcome::Gated);
    if (i % 3 == 0) fusion.add(Sensor::Stereo, 0.01 * i, 4.0 + 0.05 * (i % 2), kStereoVariance_m2);
  }
}

TEST(RangeFusionFaults, ALidarThatRepeatsItselfOnGlassStillRules) {
  RangeFusion fusion((FusionConfig()));
  for (int i = 0; i < 300; ++i) {  // at rest before a pane at 2 m; what moves behind it is all that stereo sees
    const double stamp = 0.01 * i;
    fusion.add(Sensor::Lidar, stamp, 2.0, kLidarVariance_m2);
    if (i % 3 == 0) fusion.add(Sensor::Stereo, stamp, 6.0 + std::sin(3.0 * stamp), kStereoVariance_m2);
    if (i > 100) {
      ASSERT_NEAR(fusion.at(stamp).range_m, 2.0, 0.1) << i;
    }
  }
}

TEST(RangeFusionFaults, ALoneReadingIsNoRangeUntilASecondConfirmsIt) {
  RangeFusion fusion((FusionConfig()));
  fusion.add(Sensor::Lidar, 1.0, 1.5, kLidarVariance_m2);  // a spike into open sky
  EXPECT_TRUE(std::isnan(fusion.at(1.0).range_m));
  fusion.add(Sensor::Lidar, 1.01, 7.0, kLidarVariance_m2);
  EXPECT_TRUE(std::isnan(fusion.at(1.01).range_m));
  fusion.add(Sensor::Stereo, 1.02, 7.05, kStereoVariance_m2);
  EXPECT_NEAR(fusion.at(1.02).range_m, 7.0, 0.1);
}

}  // namespace
}  // namespace flight_corridor
