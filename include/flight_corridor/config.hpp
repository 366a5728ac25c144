#pragma once

#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/corridor/free_areas.hpp"
#include "flight_corridor/corridor/safe_speed.hpp"
#include "flight_corridor/map/map_config.hpp"
#include "flight_corridor/parameter.hpp"
#include "flight_corridor/range/beam_footprint.hpp"
#include "flight_corridor/range/range_fusion.hpp"
#include "flight_corridor/range/scale_correction.hpp"
#include "flight_corridor/stereo/disparity_estimator.hpp"

namespace flight_corridor {

/// Section `cloud/` of doc/parameters.md: the published cloud.
struct CloudConfig {
  double max_range_m = 8.0;
  int min_neighbours = 3;
  double disparity_sigma_px = 0.5;
};

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
/// The one table of the parameters: what may be set, what it may be, and what it means.
std::vector<ParameterTable> tablesOf(Config& config);
/// Every broken rule of every section, and between them.
Violations check(const Config& config);

}  // namespace flight_corridor
