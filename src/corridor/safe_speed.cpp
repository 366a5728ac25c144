#include "flight_corridor/corridor/safe_speed.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

Violations check(const SpeedConfig& config) {
  Rules rules("speed");
  rules.require(0.0 <= config.delay_s && config.delay_s <= 5.0, "delay_s", "0 to 5", config.delay_s);
  rules.require(0.0 < config.acceleration_mps2 && config.acceleration_mps2 <= 100.0, "acceleration_mps2",
                "above 0, up to 100", config.acceleration_mps2);
  rules.require(0.0 < config.jerk_mps3 && config.jerk_mps3 <= 1000.0, "jerk_mps3", "above 0, up to 1000",
                config.jerk_mps3);
  rules.require(0.0 <= config.margin_m && config.margin_m <= 5.0, "margin_m", "0 to 5", config.margin_m);
  rules.require(0.0 <= config.mover_mps && config.mover_mps <= 10.0, "mover_mps", "0 to 10", config.mover_mps);
  return rules.broken();
}

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
