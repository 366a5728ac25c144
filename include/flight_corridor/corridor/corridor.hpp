#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <string>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `corridor/`: the UAV-sized box ahead, and when it is not FREE.
struct CorridorConfig {
  std::string frame_id;   ///< "" = along the left camera's optical axis; else along +x of this frame, by tf.
  bool level = false;     ///< Level, along the heading: whoever calls pointAlong() sees to it.
  double width_m = 1.2;   ///< Of the UAV with what it needs beside it.
  double height_m = 0.4;  ///< Of the UAV with what it needs above and below.
  double length_m = 4.0;  ///< D_min: nearer obstacles block.
  Eigen::Vector3d offset_m{0, 0, 0};  ///< Shift of the box's start: forward, left, up.
  double margin_m = 0.0;              ///< Added on every side and at the end.
  double blind_m = 0.4;               ///< Nearer to the camera nothing needs to have been observed.
  double max_unknown_fraction = 0.3;  ///< More unobserved volume than this: UNKNOWN, also without a hole.
  double smallest_obstacle_m = 0.05;  ///< Edge of a square: what blocks, hides in a hole or makes doubt is as large.
  double hold_s = 0.25;    ///< After BLOCKED nothing is FREE for so long, but what was broad and is seen to have gone.
  double max_age_s = 0.5;  ///< Evidence older than this: UNKNOWN.
};
/// Every broken rule.
Violations check(const CorridorConfig& config);

/// Edge of what is looked for in a box: smallest_obstacle_m, but no less than 3 cm, as patches of chance are smaller.
double smallestInspected(const CorridorConfig& config);

/// What an octree remembers of a box, by the cells centred in it.
struct BoxCells {
  double clear_distance_m = kInfinity;  ///< Along the box's axis to where the nearest occupied one begins.
  double unknown_fraction = 1.0;        ///< Share of them that is unknown; of a box thinner than a cell all is.
};
BoxCells cellsIn(const octomap::OcTree& tree, const Box& box);

/// The configured box, margin and offset applied, in a frame M.
/// @param T_M_F frame that the corridor belongs to (x forward) in M.
Box corridorBox(const CorridorConfig& config, const Eigen::Isometry3d& T_M_F);

}  // namespace flight_corridor
