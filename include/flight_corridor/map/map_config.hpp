#pragma once

#include <string>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `map/` of doc/parameters.md: the OctoMap, and the rules for occupied and free cells.
struct MapConfig {
  std::string frame_id;
  double resolution_m = 0.10;
  double max_range_m = 8.0;
  double hit_fraction = 0.15;
  int min_hit_points = 4;
  double hit_band_px = 0.12;
  double free_band_px = 0.5;
  double min_ray_fraction = 0.4;
  double log_odds_hit = 2.0;
  double log_odds_miss = -1.1;
  double log_odds_min = -2.0;
  double log_odds_max = 2.0;
  double forget_s = 10.0;
};
Violations check(const MapConfig& config);

/// Coordinates below which OctoMap has keys for cells [m].
double mapReach(const MapConfig& config);
/// Largest coordinate of a camera in a fixed frame: cells up to max_range_m away have keys [m].
double farthestCamera(const MapConfig& config);

}  // namespace flight_corridor
