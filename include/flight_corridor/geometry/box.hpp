#pragma once

#include <Eigen/Geometry>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

constexpr double kTouch_m = 1e-6;  ///< Boxes closer than this touch: rounding.

/// Oriented box: starts at the origin of its frame F and reaches size.x along +x (forward), centred in y (left) and z
/// (up).
struct Box {
  Eigen::Isometry3d T_M_F = Eigen::Isometry3d::Identity();
  Eigen::Vector3d size_m{0, 0, 0};
};

/// Broken rules of a box: an invalid pose, sides that are not above 0 and up to 100 m, or so large a surface that
/// judging it would take longer than a frame.
Violations check(const Box& box, double cell_m);

/// Not scaled, not sheared, not mirrored.  @param tolerance of its columns' products.
bool isRotation(const Eigen::Matrix3d& R, double tolerance = kTouch_m);

/// Of the box, in M [m].
Eigen::Vector3d centre(const Box& box);

/// Whether a point is in a box, the far end excluded: an obstacle there is farther than D_min.
bool contains(const Box& box, const Eigen::Vector3d& point_M);
/// The same in the box's own frame, for many points.
bool contains(const Eigen::Vector3d& size_m, const Eigen::Vector3d& point_F);

/// Whether an oriented box and a cube share a point (separating axes, Gottschalk 1996). Touching counts.
bool intersects(const Box& box, const Eigen::Vector3d& cube_centre_M, double cube_edge_m);

/// Where a ray from the origin of M enters and leaves a box, as multiples of its direction; negative behind the origin.
struct Crossing {
  double entry, exit;
  bool meets() const { return entry < exit && exit > 0.0; }
};
Crossing crossing(const Eigen::Isometry3d& T_F_M, const Eigen::Vector3d& size_m, const Eigen::Vector3d& direction_M);

/// Of its corners, along z of M [m].
double farthestCorner(const Box& box);
double nearestCorner(const Box& box);

}  // namespace flight_corridor
