#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "flight_corridor/corridor/safe_speed.hpp"

namespace flight_corridor {
namespace {

/// How far a UAV flies on that begins to brake after a delay: its acceleration builds up with the jerk, and goes before
/// it stands. Small steps of time.
double stoppingDistance(double speed_mps, double delay_s, const SpeedConfig& config) {
  constexpr double kStep_s = 1e-4;
  double distance_m = speed_mps * delay_s, braking_mps2 = 0.0;
  while (speed_mps > 0.0) {
    const double going_mps2 = std::sqrt(2.0 * config.jerk_mps3 * speed_mps);  // from there the jerk takes it to 0
    const double wanted_mps2 = std::min(config.acceleration_mps2, going_mps2);
    braking_mps2 = std::min(braking_mps2 + config.jerk_mps3 * kStep_s, wanted_mps2);
    speed_mps -= braking_mps2 * kStep_s;
    distance_m += std::max(0.0, speed_mps) * kStep_s;
  }
  return distance_m;
}

TEST(SafeSpeed, TimeToStandIsThatOfTheDistanceFormula) {
  const SpeedConfig config;
  EXPECT_DOUBLE_EQ(timeToStand(0.0, 0.2, config), 0.3 + 0.2 + 2.0 * 3.0 / 8.0);
  EXPECT_DOUBLE_EQ(timeToStand(3.0, 0.0, config), 0.3 + 2.0 * 3.0 / 8.0 + 1.0);
}

TEST(SafeSpeed, IsTheNumberOfTheLaw) {
  SpeedConfig config;
  config.delay_s = 0.0;
  config.margin_m = 0.0;
  EXPECT_NEAR(safeSpeed(4.0, 0.0, config), 3.1410, 0.0001) << "v^2 + 4.5 v - 24 = 0";
  config = SpeedConfig();
  config.delay_s = 0.1;
  EXPECT_NEAR(safeSpeed(4.0, 0.03, config), 2.7609, 0.0001) << "v^2 + (4.5 + 0.78) v - 22.2 = 0";
}

TEST(SafeSpeed, FromItTheUavStopsWithinWhatIsFreeTheMarginKept) {
  for (const double acceleration_mps2 : {1.0, 3.0, 8.0}) {
    for (const double jerk_mps3 : {2.0, 8.0, 40.0}) {
      for (const double free_m : {0.4, 1.0, 2.0, 4.0, 8.0, 20.0}) {
        for (const double age_s : {0.0, 0.03, 0.2}) {
          SpeedConfig config;
          config.acceleration_mps2 = acceleration_mps2;
          config.jerk_mps3 = jerk_mps3;
          const double speed_mps = safeSpeed(free_m, age_s, config);
          const double stop_m = stoppingDistance(speed_mps, age_s + config.delay_s, config);
          EXPECT_LE(stop_m, free_m - config.margin_m) << free_m << " m " << acceleration_mps2 << ' ' << jerk_mps3;
          EXPECT_GT(speed_mps, 0.0);
        }
      }
    }
  }
}

TEST(SafeSpeed, NothingIsFreeNoSpeedIsSafe) {
  for (const double free_m : {0.0, -1.0, kNaN, 0.3}) EXPECT_EQ(safeSpeed(free_m, 0.0, SpeedConfig()), 0.0) << free_m;
  EXPECT_EQ(safeSpeed(4.0, kNaN, SpeedConfig()), 0.0);
}

TEST(SafeSpeed, MoreDelayOrLessFreeIsNeverFaster) {
  double before = kInfinity;
  for (double age_s = 0.0; age_s < 1.0; age_s += 0.05) {
    EXPECT_LT(safeSpeed(4.0, age_s, SpeedConfig()), before);
    before = safeSpeed(4.0, age_s, SpeedConfig());
  }
  EXPECT_EQ(safeSpeed(4.0, -1.0, SpeedConfig()), safeSpeed(4.0, 0.0, SpeedConfig())) << "no verdict is from the future";
}

}  // namespace
}  // namespace flight_corridor
