#include "flight_corridor/config.hpp"

#include <algorithm>

namespace flight_corridor {

namespace {

void append(Violations& all, const Violations& some) { all.insert(all.end(), some.begin(), some.end()); }

}  // namespace

Violations check(const CloudConfig& config) {
  Rules rules("cloud");
  rules.require(config.max_range_m > 0.0, "max_range_m", "positive", config.max_range_m);
  rules.require(0 <= config.min_neighbours && config.min_neighbours <= 8, "min_neighbours", "0 to 8",
                config.min_neighbours);
  rules.require(config.disparity_sigma_px > 0.0, "disparity_sigma_px", "positive", config.disparity_sigma_px);
  return rules.broken();
}

Violations check(const Config& config) {
  Violations broken;
  append(broken, check(config.stereo));
  append(broken, check(config.lidar));
  append(broken, check(config.fusion));
  append(broken, check(config.scale));
  append(broken, check(config.cloud));
  append(broken, check(config.map));
  append(broken, check(config.corridor));
  append(broken, check(config.speed));
  append(broken, check(config.free_areas));
  Rules map("map"), speed("speed");
  const double box_m = config.corridor.length_m + config.corridor.margin_m;
  map.require(config.map.max_range_m >= std::max(0.0, config.corridor.offset_m.x()) + box_m, "max_range_m",
              "no less than corridor/length_m + corridor/margin_m + corridor/offset_m ahead", config.map.max_range_m);
  speed.require(config.speed.margin_m < box_m, "margin_m",
                "below corridor/length_m + corridor/margin_m, else no speed is ever safe", config.speed.margin_m);
  append(broken, map.broken());
  append(broken, speed.broken());
  return broken;
}

}  // namespace flight_corridor
