#pragma once

#include <map>
#include <string>

#include "sim/random.hpp"
#include "sim/worlds.hpp"

namespace flight_corridor::sim {

/// Fills a world that has a rig, a start and a goal.
using WorldBuilder = void (*)(World&, Random&);

std::map<std::string, WorldBuilder> outdoorBuilders();  ///< Woods, hills, streets, people.
std::map<std::string, WorldBuilder> indoorBuilders();   ///< Halls, gates, rooms.

}  // namespace flight_corridor::sim
