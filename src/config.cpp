#include "flight_corridor/config.hpp"

namespace flight_corridor {

namespace {

void append(Violations& all, const Violations& some) { all.insert(all.end(), some.begin(), some.end()); }

}  // namespace

Violations check(const Config& config) {
  Violations broken;
  append(broken, check(config.stereo));
  append(broken, check(config.lidar));
  append(broken, check(config.fusion));
  append(broken, check(config.scale));
  append(broken, check(config.cloud));
  append(broken, check(config.map));
  append(broken, check(config.corridor));
  Rules rules("map");
  rules.require(config.map.max_range_m >= config.corridor.length_m + config.corridor.margin_m, "max_range_m",
                "no less than corridor/length_m + corridor/margin_m", config.map.max_range_m);
  append(broken, rules.broken());
  return broken;
}

}  // namespace flight_corridor
