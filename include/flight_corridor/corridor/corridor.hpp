#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <functional>
#include <string>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `corridor/`: the UAV-sized box ahead, and when it is not FREE.
struct CorridorConfig {
  std::string frame_id;   ///< "" = along the left camera's optical axis; else along +x of this frame, by tf.
  double width_m = 1.2;   ///< Of the UAV with what it needs beside it.
  double height_m = 0.4;  ///< Of the UAV with what it needs above and below.
  double length_m = 4.0;  ///< D_min: nearer obstacles block.
  Eigen::Vector3d offset_m{0, 0, 0};  ///< Shift of the box's start: forward, left, up.
  double margin_m = 0.0;              ///< Added on every side and at the end.
  double blind_m = 0.4;               ///< Nearer to the camera nothing needs to have been observed.
  double max_unknown_fraction = 0.1;  ///< More unobserved volume than this: UNKNOWN.
  double smallest_obstacle_m = 0.05;  ///< Edge of a square: smaller patches of matches are dropped; 0: none is.
  double hold_s = 0.25;    ///< After BLOCKED nothing is FREE for so long, but what was broad and is seen to have gone.
  double max_age_s = 0.5;  ///< Evidence older than this: UNKNOWN.
};
/// Every broken rule.
Violations check(const CorridorConfig& config);

/// What the octree says of a box.
struct CorridorOccupancy {
  double clear_distance_m =
      kInfinity;                  ///< Along the box's axis to where the nearest occupied cell begins; +inf when none.
  double unknown_fraction = 1.0;  ///< Unknown share of the cells that should be known; 1 when there is none of these.
};

/// Where along a box's axis [m] what an occupied cell holds of it begins; +inf where it holds nothing in the box.
/// @param near_m where the cell itself begins.
using CellBegin = std::function<double(const Eigen::Vector3d& cell_centre_M, double near_m)>;

/// The nearest occupied cell that shares a point with the box, and the unknown share of the cells centred in it. Both
/// by descent: cubes outside are left out, cubes wholly inside are decided at once. A box thinner than a cell may hold
/// no cell's centre, one that reaches out of the octree is not judged by its part inside: both are unknown altogether.
/// @param tree inner nodes up to date (octomap::OcTree::updateInnerOccupancy).
/// @param needed_M cells centred outside this region of M need not be known.
/// @param begin no less than near_m; without it cells are taken to be full.
CorridorOccupancy inspectBox(const octomap::OcTree& tree, const Box& box, const ConvexRegion& needed_M,
                             const CellBegin& begin = nullptr);

/// The UAV-sized box ahead, tested against an octree.
class Corridor {
 public:
  /// @throws std::invalid_argument with every broken rule.
  explicit Corridor(const CorridorConfig& config);

  /// The configured box, margin and offset applied, in map frame M.
  /// @param T_M_F frame that the corridor belongs to (x forward) in M.
  Box box(const Eigen::Isometry3d& T_M_F) const;

  /// inspectBox() where only what lies farther along the box's axis than blind_m before the camera must be known, and
  /// of that what could be observed: near the camera no view is as wide as the box. But of the box's last quarter all
  /// must be known unless two thirds of it could be observed.
  /// @param observable_M where a surface is on both images, also one too near to be matched.
  CorridorOccupancy inspect(const octomap::OcTree& tree, const Box& box, const Eigen::Vector3d& camera_M,
                            const ConvexRegion& observable_M, const CellBegin& begin = nullptr) const;

 private:
  CorridorConfig config_;
};

}  // namespace flight_corridor
