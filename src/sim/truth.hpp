#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "flight_corridor/types.hpp"
#include "sim/world.hpp"

namespace flight_corridor::sim {

/// Distance along the left camera's optical axis to the first true surface in the corridor's box; +inf: none [m].
struct CorridorTruth {
  double clear_exact_m = kInfinity;     ///< In the box itself.
  double clear_shrunk_m = kInfinity;    ///< In the box 0.10 m smaller on every side and at the end.
  double clear_inflated_m = kInfinity;  ///< In the box 0.10 m larger on every side and at the end.
};

/// Whether a box and a primitive share a point: the minimum-norm point of their Minkowski difference (Wolfe 1976;
/// Gilbert, Johnson and Keerthi 1988), exact to 1e-6 m.
/// @param T_W_F  origin at the middle of the box's near face, x forward.
/// @param size_m length along x, width along y, height along z.
bool overlaps(const Eigen::Isometry3d& T_W_F, const Eigen::Vector3d& size_m, const Primitive& primitive);

/// How far a box and a primitive are apart [m]; 0: they overlap. Exact to 1e-3 m.
double gapBetween(const Eigen::Isometry3d& T_W_F, const Eigen::Vector3d& size_m, const Primitive& primitive);

/// Distance along x of F at which a box that grows from F first meets a primitive; +inf if it never does [m].
double clearDistance(const std::vector<Primitive>& primitives, const Eigen::Isometry3d& T_W_F,
                     const Eigen::Vector3d& size_m);

/// Truth of one moment.
/// @param corridor_m length, width, height of the exact box.
CorridorTruth corridorTruth(const std::vector<Primitive>& primitives, const Eigen::Isometry3d& T_W_C,
                            const Eigen::Vector3d& corridor_m);

}  // namespace flight_corridor::sim
