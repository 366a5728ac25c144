#include "flight_corridor/config.hpp"

#include <algorithm>

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
  const double end_m =
      std::max(0.0, config.corridor.offset_m.x()) + config.corridor.length_m + config.corridor.margin_m;
  rules.require(config.map.max_range_m >= end_m, "max_range_m",
                "no less than corridor/length_m + corridor/margin_m + what corridor/offset_m adds ahead",
                config.map.max_range_m);
  append(broken, rules.broken());
  return broken;
}

}  // namespace flight_corridor
