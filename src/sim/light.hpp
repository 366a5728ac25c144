#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "flight_corridor/types.hpp"
#include "sim/projector.hpp"
#include "sim/shadows.hpp"

namespace flight_corridor::sim {

/// The light of a world.
struct Light {
  Eigen::Vector3d to_sun_W = Eigen::Vector3d(-0.5, 0.4, 0.75).normalized();
  float ambient = 0.55f;                   ///< Share of the light that comes from everywhere; the rest is the sun's.
  double haze_m = kInfinity;               ///< At this distance 63 % of the image's grey is haze.
  bool has_clouds = false;                 ///< false: a white sky.
  std::shared_ptr<const Shadows> shadows;  ///< Null: nothing throws a shadow.
  std::optional<ProjectedDots> dots;       ///< Absent: no projector.
};

}  // namespace flight_corridor::sim
