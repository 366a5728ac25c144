#pragma once

#include <Eigen/Geometry>
#include <string>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `corridor/`: the UAV-sized box ahead, and the conditions of FREE.
struct CorridorConfig {
  std::string frame_id;   ///< "" = along the left camera's optical axis; else along +x of this frame, by tf.
  bool level = false;     ///< Level, along the heading: the caller of pointAlong() ensures it.
  double width_m = 1.2;   ///< Of the UAV and the clearance that it needs beside it.
  double height_m = 0.4;  ///< Of the UAV and the clearance that it needs above and below.
  double length_m = 4.0;  ///< D_min: nearer obstacles block.
  Eigen::Vector3d offset_m{0, 0, 0};  ///< Shift of the box's start: forward, left, up.
  double margin_m = 0.0;              ///< Added on every side and at the end.
  double blind_m = 0.4;               ///< Space nearer to the camera need not have been observed.
  double max_unknown_fraction = 0.3;  ///< With more unobserved volume: UNKNOWN, even without a hole.
  double smallest_obstacle_m = 0.05;  ///< Edge of a square: the size of a patch, a hole or doubt.
  double hold_s = 0.25;    ///< No FREE for this long where something blocked, unless a large patch is seen to have gone.
  double memory_s = 1.5;   ///< Space that earlier pairs saw clear counts as clear for so long; 0: not at all.
  double max_age_s = 0.5;  ///< Evidence older than this: UNKNOWN.
};
/// Every broken rule.
Violations check(const CorridorConfig& config);

/// Edge of the obstacles searched in a box: smallest_obstacle_m, but at least 1 cm.
double smallestInspected(const CorridorConfig& config);

/// The configured box, margin and offset applied, in a frame M.
/// @param T_M_F frame that the corridor belongs to (x forward) in M.
Box corridorBox(const CorridorConfig& config, const Eigen::Isometry3d& T_M_F);

}  // namespace flight_corridor
