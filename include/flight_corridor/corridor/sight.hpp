#pragma once

#include "flight_corridor/corridor/box_inspector.hpp"
#include "flight_corridor/map/obstacle_memory.hpp"

namespace flight_corridor {

/// What the newest pair shows in a small cube: Nothing if it is nearer than stereo sees or not all in view of both
/// cameras, Clear if nearly all rays pass it, else Unclear.
/// @param centre_C in C [m].  @param edge_m of the cube.
Sight sightOf(const PairEvidence& pair, const StereoGeometry& geometry, const Eigen::Vector3d& centre_C, double edge_m);

}  // namespace flight_corridor
