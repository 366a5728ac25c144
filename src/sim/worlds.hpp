#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/scenes.hpp"

namespace flight_corridor::sim {

/// A world to be flown through freely: from the scene's start, over W's origin and looking along +x, to a goal.
struct World {
  Scene scene;                             ///< Its flight gives the start only.
  Eigen::Vector3d goal_W{24.0, 0.0, 1.5};  ///< 20 m and more away.
  Eigen::AlignedBox2d ground_W{Eigen::Vector2d(-2.0, -9.0), Eigen::Vector2d(26.0, 9.0)};  ///< Area of ways.
};

/// In alphabetical order.
std::vector<std::string> worldNames();

/// @param seed varies places, sizes and textures.
/// @throws std::invalid_argument naming the unknown world and the known ones.
World makeWorld(const std::string& name, std::uint64_t seed);

/// Those of which a bounding sphere is nearer to a point than a distance.
std::vector<Primitive> primitivesNear(const std::vector<Primitive>& primitives, const Eigen::Vector3d& p_W,
                                      double distance_m);

/// Whether a body, round from above, gets from start to goal at the height of flight: a search on a grid of 0.1 m,
/// over what does not move.
/// @param width_m, height_m of the body.
bool wayExists(const World& world, double width_m, double height_m);

}  // namespace flight_corridor::sim
