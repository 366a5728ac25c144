#pragma once

#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `speed/`: how the UAV brakes.
struct SpeedConfig {
  double delay_s = 0.3;  ///< From a verdict to where the UAV begins to brake; the verdict's own age comes on top.
  double acceleration_mps2 = 3.0;  ///< With which it brakes.
  double jerk_mps3 = 8.0;          ///< With which it begins to.
  double margin_m = 0.3;           ///< Left between the stopped UAV and what is not free.
};
/// Every broken rule.
Violations check(const SpeedConfig& config);

/// The speed [m/s] from which the UAV still stops within what is free, the margin kept: d = v t + v 2a/j + v²/2a, as in
/// PX4's collision prevention (its b is 4a²/j + 2at here, for the delay t).
/// @param free_m from the UAV on [m]; NaN: not known.  @param age_s of the verdict when it is acted upon.
/// @return 0 where nothing is free, or not known to be.
double safeSpeed(double free_m, double age_s, const SpeedConfig& config);

}  // namespace flight_corridor
