#pragma once

#include "flight_corridor/beam_footprint.hpp"
#include "flight_corridor/cloud_builder.hpp"
#include "flight_corridor/corridor.hpp"
#include "flight_corridor/disparity_estimator.hpp"
#include "flight_corridor/map_config.hpp"
#include "flight_corridor/range_fusion.hpp"
#include "flight_corridor/scale_correction.hpp"

namespace flight_corridor {

/// Every module's configuration; the YAML's sections bear the members' names.
struct Config {
  StereoConfig stereo;
  LidarConfig lidar;
  FusionConfig fusion;
  ScaleConfig scale;
  CloudConfig cloud;
  MapConfig map;
  CorridorConfig corridor;
};
/// Every broken rule of every section.
Violations check(const Config& config);

}  // namespace flight_corridor
