#pragma once

#include <cstddef>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"
#include "sim/simulation.hpp"

namespace flight_corridor::test_support {

inline sim::SimulationOptions parallelWires() {
  sim::SimulationOptions options;
  options.scene = "wire";
  options.seed = 19;
  options.rate_hz = 4.0;
  return options;
}

/// A pair in which two wires at 1.8 m are each matched with the other, and found behind the corridor.
struct ParallelWires {
  static constexpr std::size_t kFrame = 16;
  sim::Simulation simulation{parallelWires()};
  StereoFrame frame = simulation.frame(kFrame);
  StereoGeometry geometry{simulation.calibration()};
};

}  // namespace flight_corridor::test_support
