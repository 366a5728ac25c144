#pragma once

#include <Eigen/Geometry>
#include <cstdint>

namespace flight_corridor::sim {

/// A projector of dots on the rig, as a RealSense D435 or an OAK-D Pro has one: an array of lasers whose pseudo-random
/// layout a grating repeats side by side. About 5000 dots in 86 x 57 degrees, here 5 x 3 times the same layout.
/// Model: irradiance = strength * pattern(direction) * cos(incidence) / distance^2.
struct DotProjector {
  Eigen::Isometry3d T_C_P = Eigen::Isometry3d::Identity();  ///< P is optical; C is the left camera.
  double strength = 1.0;   ///< Irradiance in the middle of a dot 1 m ahead, of the scene's own light: 1 is white in it.
  std::uint32_t seed = 0;  ///< Of the layout.
};

/// The projector at a moment.
struct ProjectedDots {
  DotProjector projector;
  Eigen::Isometry3d T_P_W;

  /// Irradiance of a surface, if nothing is in between; 0 where no camera sees it.
  /// @param normal_W unit.  @param footprint edge of the camera's pixel as a slope: dots are no sharper.
  float light(const Eigen::Vector3f& point_W, const Eigen::Vector3f& normal_W, float footprint) const;
};

/// Light of the pattern in a direction: 1 in the middle of a dot, 0 beside all.
/// @param across, down slopes in P.
float dotPattern(float across, float down, float footprint, std::uint32_t seed);

}  // namespace flight_corridor::sim
