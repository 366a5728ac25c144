#pragma once

#include "flight_corridor/corridor/box_inspector.hpp"
#include "flight_corridor/map/obstacle_memory.hpp"

namespace flight_corridor {

/// What the newest pair shows in a small cube: Clear if the rays of nearly all its pixels pass it, Surface if
/// matches on texture lie in it.
/// @param centre_C in C [m].  @param edge_m of the cube.
Sight sightOf(const PairEvidence& pair, const StereoGeometry& geometry, const Eigen::Vector3d& centre_C, double edge_m);

}  // namespace flight_corridor
