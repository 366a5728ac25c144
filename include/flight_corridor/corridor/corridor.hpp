#pragma once

#include <Eigen/Geometry>
#include <string>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `corridor/` of doc/parameters.md: the UAV-sized box ahead, and the conditions of FREE.
struct CorridorConfig {
  std::string frame_id;
  bool level = false;  ///< The caller of pointAlong() ensures it.
  double width_m = 1.2;
  double height_m = 0.4;
  double length_m = 4.0;
  Eigen::Vector3d offset_m{0, 0, 0};
  double margin_m = 0.0;
  double blind_m = 0.4;
  double max_unknown_fraction = 0.3;
  double smallest_obstacle_m = 0.05;
  double hold_s = 0.25;
  double memory_s = 1.5;
  double max_age_s = 0.5;
};
/// Every broken rule.
Violations check(const CorridorConfig& config);

/// Edge of the obstacles searched in a box: smallest_obstacle_m, but at least 1 cm.
double smallestInspected(const CorridorConfig& config);

/// The configured box, margin and offset applied, in a frame M.
/// @param T_M_F frame that the corridor belongs to (x forward) in M.
Box corridorBox(const CorridorConfig& config, const Eigen::Isometry3d& T_M_F);

}  // namespace flight_corridor
