#include "flight_corridor/corridor/corridor.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kSmallest_m = 0.01;  // edge: of smaller ones a pixel is one

}  // namespace

Violations check(const CorridorConfig& config) {
  Rules rules("corridor");
  rules.require(0.0 < config.width_m && config.width_m <= 20.0, "width_m", "above 0, up to 20", config.width_m);
  rules.require(0.0 < config.height_m && config.height_m <= 20.0, "height_m", "above 0, up to 20", config.height_m);
  rules.require(0.0 < config.length_m && config.length_m <= 100.0, "length_m", "above 0, up to 100", config.length_m);
  for (int axis = 0; axis < 3; ++axis) {
    rules.require(std::abs(config.offset_m[axis]) <= 10.0, "offset_m", "within 10", config.offset_m[axis]);
  }
  rules.require(0.0 <= config.margin_m && config.margin_m <= 5.0, "margin_m", "0 to 5", config.margin_m);
  rules.require(0.0 <= config.blind_m && config.blind_m < config.length_m, "blind_m", "0 to below length_m",
                config.blind_m);
  rules.require(0.0 <= config.max_unknown_fraction && config.max_unknown_fraction <= 1.0, "max_unknown_fraction",
                "0 to 1", config.max_unknown_fraction);
  rules.require(0.0 <= config.smallest_obstacle_m && config.smallest_obstacle_m <= 1.0, "smallest_obstacle_m", "0 to 1",
                config.smallest_obstacle_m);
  rules.require(0.0 <= config.hold_s && config.hold_s <= 10.0, "hold_s", "0 to 10", config.hold_s);
  rules.require(0.0 <= config.memory_s && config.memory_s <= 10.0, "memory_s", "0 to 10", config.memory_s);
  rules.require(config.max_age_s > 0.0, "max_age_s", "positive", config.max_age_s);
  return rules.broken();
}

double smallestInspected(const CorridorConfig& config) { return std::max(config.smallest_obstacle_m, kSmallest_m); }

Box corridorBox(const CorridorConfig& config, const Eigen::Isometry3d& T_M_F) {
  Box box;
  box.T_M_F = T_M_F * Eigen::Translation3d(config.offset_m);
  const double margin = config.margin_m;
  box.size_m = {config.length_m + margin, config.width_m + 2.0 * margin, config.height_m + 2.0 * margin};
  return box;
}

}  // namespace flight_corridor
