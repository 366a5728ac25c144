#pragma once

#include <Eigen/Core>

#include "sim/world.hpp"

namespace flight_corridor::sim {

/// Reflectance of a surface, averaged over what one pixel sees of it: octaves of noise that are finer than the pixel's
/// footprint are faded out, so that far surfaces do not alias.
/// @param p_O          point of the surface in the object's frame [m].
/// @param footprint_m  edge of the patch that the pixel sees.
/// @return [0..1] or a little above.
float reflectance(const Material& material, const Eigen::Vector3f& p_O, float footprint_m);

/// Radiance of a blue sky with clouds. @param direction_W  of the ray, any length.
float cloudySky(const Eigen::Vector3f& direction_W);

}  // namespace flight_corridor::sim
