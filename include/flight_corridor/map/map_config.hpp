#pragma once

#include <string>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `map/`: the OctoMap, and the rules for occupied and free cells.
struct MapConfig {
  std::string frame_id;           ///< "" = camera frame, map rebuilt for each image; else the fixed frame, by tf.
  double resolution_m = 0.10;     ///< Edge of a cell.
  double max_range_m = 8.0;       ///< Depth up to which evidence is used.
  double hit_fraction = 0.15;     ///< A cell is hit by at least this share of a full face's points there.
  int min_hit_points = 4;         ///< ... and by at least this many points.
  double hit_band_px = 0.12;      ///< Surfaces are moved nearer by this disparity: a match's error.
  double free_band_px = 0.5;      ///< Space within this disparity before a surface is not cleared.
  double min_ray_fraction = 0.4;  ///< Share of a cell's view that must hold depth, all past the cell, to clear it.
  double log_odds_hit = 2.0;      ///< Added for a hit; one hit makes a cell occupied.
  double log_odds_miss = -1.1;    ///< Added for a miss; two make an occupied cell free.
  double log_odds_min = -2.0;     ///< Clamping limit below.
  double log_odds_max = 2.0;      ///< Clamping limit above.
  double forget_s = 10.0;         ///< In a fixed frame: space without evidence for this long becomes unknown.
};
Violations check(const MapConfig& config);

/// Coordinates below which OctoMap has keys for cells [m].
double mapReach(const MapConfig& config);
/// Largest coordinate of a camera in a fixed frame: cells up to max_range_m away have keys [m].
double farthestCamera(const MapConfig& config);

}  // namespace flight_corridor
