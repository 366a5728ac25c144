#pragma once

#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/corridor/free_areas.hpp"
#include "flight_corridor/corridor/safe_speed.hpp"
#include "flight_corridor/map/map_config.hpp"
#include "flight_corridor/range/beam_footprint.hpp"
#include "flight_corridor/range/range_fusion.hpp"
#include "flight_corridor/range/scale_correction.hpp"
#include "flight_corridor/stereo/disparity_estimator.hpp"

namespace flight_corridor {

/// The published cloud.
struct CloudConfig {
  double max_range_m = 8.0;         ///< Farther points are left out.
  int min_neighbours = 3;           ///< Of a pixel's 8 neighbours within 3 sigma_Z; a point with fewer is noise.
  double disparity_sigma_px = 0.5;  ///< sigma_d of that sigma_Z.
};
Violations check(const CloudConfig& config);

/// Every module's configuration; the YAML's sections have the members' names.
struct Config {
  StereoConfig stereo;
  LidarConfig lidar;
  FusionConfig fusion;
  ScaleConfig scale;
  CloudConfig cloud;
  MapConfig map;
  CorridorConfig corridor;
  SpeedConfig speed;
  FreeAreasConfig free_areas;
};
/// Every broken rule of every section.
Violations check(const Config& config);

}  // namespace flight_corridor
