#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "flight_corridor/corridor/verdict.hpp"
#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `free_areas/` of doc/parameters.md: the directions that are judged, a grid about the corridor's axis.
struct FreeAreasConfig {
  double yaw_rad = 0.5236;
  double pitch_rad = 0.1745;
  double step_rad = 0.0873;
};
/// Every broken rule.
Violations check(const FreeAreasConfig& config);

/// A direction of the grid, and whether the UAV's box along it is free.
struct FreeArea {
  double yaw_rad = 0.0;    ///< Left of the corridor's axis.
  double pitch_rad = 0.0;  ///< Above it.
  Verdict verdict;
};

/// All directions, row by row: the lowest pitch first, in a row the rightmost yaw first.
struct AreaGrid {
  int columns = 0, rows = 0;
  std::vector<FreeArea> areas;
  int best = -1;  ///< Index of the best FREE direction; -1: no direction is FREE.
};

/// The nearest obstacles around, in a level layer as high as the corridor.
struct LevelScan {
  double first_yaw_rad = 0.0, step_rad = 0.0;  ///< Left of the heading; each range is at the middle of its step.
  double max_range_m = 0.0;
  std::vector<double> range_m;  ///< From the camera on; +inf: observed free up to max_range_m, NaN: not known.
};

/// A scan in which nothing is known.
LevelScan unknownScan(double step_rad, double max_range_m);

/// The angles of a grid's columns, or rows: from -limit to limit, 0 among them.
std::vector<double> gridAngles(double limit_rad, double step_rad);

/// The grid, not judged yet.
AreaGrid areaGrid(const FreeAreasConfig& config);

/// Unit vector of a direction in the corridor's frame.
Eigen::Vector3d ahead(const FreeArea& area);

/// The FREE direction nearest to a wanted one; of those equally near, to a step, the one with most FREE neighbours.
/// @param goal_F wanted direction in the corridor's frame, of any length; an invalid one means straight ahead.
/// @return -1: no direction is FREE.
int bestArea(const AreaGrid& areas, const Eigen::Vector3d& goal_F, double step_rad);

}  // namespace flight_corridor
