#pragma once

#include <cstdint>
#include <vector>

#include "flight_corridor/types.hpp"
#include "sim/world.hpp"

namespace flight_corridor::sim {

/// The default rig's view of a static world, its left lens above W's origin at the height of flight, looking along x.
/// @param seed of the images' noise.
StereoFrame stillPair(const std::vector<Primitive>& world, std::uint64_t seed);

}  // namespace flight_corridor::sim
