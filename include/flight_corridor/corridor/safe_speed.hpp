#pragma once

#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `speed/` of doc/parameters.md: how the UAV brakes.
struct SpeedConfig {
  double delay_s = 0.3;
  double acceleration_mps2 = 3.0;
  double jerk_mps3 = 8.0;
  double margin_m = 0.3;
  double mover_mps = 1.6;
};
/// Every broken rule.
Violations check(const SpeedConfig& config);

/// The speed [m/s] from which the UAV can stop within free space, with the margin: d = v t + v 2a/j + v²/2a, as in
/// PX4's collision prevention (its b is 4a²/j + 2at here, for the delay t).
/// @param free_m from the UAV on [m]; NaN: not known.  @param age_s of the verdict when it is acted upon.
/// @return 0 if nothing is known to be free.
double safeSpeed(double free_m, double age_s, const SpeedConfig& config);

/// How long it takes until the UAV stands, by that formula: t + 2a/j + v/a [s].
double timeToStand(double speed_mps, double age_s, const SpeedConfig& config);

}  // namespace flight_corridor
