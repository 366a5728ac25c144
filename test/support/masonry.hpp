#pragma once

#include "sim/random.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::test_support {

/// A wall that fills the view, also below the horizon: there is no ground.
inline sim::Primitive masonryAt(double x_m) {
  sim::Random random(1, sim::Stream::Scene);
  return sim::makeBox({x_m + 0.5, 0.0, sim::kHeight_m}, {1.0, 60.0, 60.0}, sim::masonry(random));
}

/// A cube of masonry.
inline sim::Primitive cubeAt(const Eigen::Vector3d& middle_W, double size_m) {
  sim::Random random(2, sim::Stream::Scene);
  return sim::makeBox(middle_W, Eigen::Vector3d::Constant(size_m), sim::masonry(random));
}

}  // namespace flight_corridor::test_support
