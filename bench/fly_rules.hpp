#pragma once

#include <string>

#include "sim/closed_loop.hpp"

namespace flight_corridor::bench {

/// The rule of a yardstick: straight ahead, level, where the corridor of 4 m is FREE; else no way.
/// paper: d_K >= 4 m, of the WLS depth at the window's centre and the LiDAR's range, as in yardsticks.cpp.
/// stock: no leaf of an OctoMap of SGBM's cloud is occupied in the corridor's box.
/// After it turned on the spot it keeps its heading for a while, then it turns back to the goal as it flies.
/// @param disparities_px search range.
/// @throws std::invalid_argument naming the unknown rule and the known ones.
sim::Rule yardstick(const std::string& name, const sim::ClosedLoop& loop, int disparities_px);

}  // namespace flight_corridor::bench
