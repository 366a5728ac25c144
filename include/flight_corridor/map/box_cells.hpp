#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Core>
#include <functional>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// The nearest occupied cell that is centred in a box, or, of a box thinner than a cell, that meets it.
struct OccupiedCell {
  double clear_distance_m = kInfinity;       ///< Along the box's axis to the cell; +inf: none is occupied.
  Eigen::Vector3d centre{kNaN, kNaN, kNaN};  ///< In the frame of the box's pose; NaN: none.
};

/// @param tree whose inner nodes hold the most of their children.
/// @param counts whether an occupied cell counts, by its centre.
OccupiedCell nearestOccupied(
    const octomap::OcTree& tree, const Box& box,
    const std::function<bool(const Eigen::Vector3d& centre_M)>& counts = [](const auto&) { return true; });

/// Share of a box's volume without known cells [0..1]; 1 for a box thinner than a cell that no cell is centred in, or
/// that reaches out of the tree.
double unknownFraction(const octomap::OcTree& tree, const Box& box);

}  // namespace flight_corridor
