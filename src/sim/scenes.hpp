#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/flight.hpp"
#include "sim/lidar.hpp"
#include "sim/rig.hpp"
#include "sim/world.hpp"

namespace flight_corridor::sim {

/// Everything that a simulated recording is made from.
struct Scene {
  std::vector<Primitive> world;
  Rig rig;
  LidarModel lidar;
  Flight flight;
};

/// @param seed varies positions, speeds, textures and exposure.
/// @throws std::invalid_argument naming the unknown scene and the known ones.
Scene makeScene(const std::string& name, std::uint64_t seed);

/// Names that makeScene() knows, in alphabetical order.
std::vector<std::string> sceneNames();

}  // namespace flight_corridor::sim
