#include "flight_corridor/corridor/safe_speed.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

double safeSpeed(double free_m, double age_s, const SpeedConfig& config) {
  const double distance_m = free_m - config.margin_m;
  if (!(distance_m > 0.0) || !std::isfinite(age_s)) return 0.0;
  const double a = config.acceleration_mps2;
  const double b = 4.0 * a * a / config.jerk_mps3 + 2.0 * a * (config.delay_s + std::max(0.0, age_s));
  return 0.5 * (-b + std::sqrt(b * b + 8.0 * a * distance_m));
}

double timeToStand(double speed_mps, double age_s, const SpeedConfig& config) {
  const double a = config.acceleration_mps2;
  return config.delay_s + std::max(0.0, age_s) + 2.0 * a / config.jerk_mps3 + speed_mps / a;
}

}  // namespace flight_corridor
