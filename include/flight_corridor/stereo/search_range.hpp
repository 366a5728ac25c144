#pragma once

#include <cmath>

#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

constexpr int kBelowZero_px = 2;  ///< Searched below zero: far surfaces of a rig with an offset.

/// Smallest u_l - u_r that is searched.
inline int smallestDisparity(const StereoGeometry& geometry) {
  return static_cast<int>(std::floor(geometry.principalPointDifference())) - kBelowZero_px;
}

/// The disparity of bit 0 of the sets, principal-point difference removed [px].
inline double firstDisparity(const StereoGeometry& geometry) {
  return smallestDisparity(geometry) - geometry.principalPointDifference();
}

}  // namespace flight_corridor
