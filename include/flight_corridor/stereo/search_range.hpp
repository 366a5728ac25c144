#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

constexpr int kBelowZero_px = 2;                       ///< Searched below zero: far surfaces of a rig with an offset.
constexpr float kLargestOffset_px = 1.5f;              ///< Of such a rig; what is still farther is a wrong match.
constexpr float kSmallestDisparity_px = 1.0f / 16.0f;  ///< As far as can be resolved.

/// Smallest u_l - u_r that is searched.
inline int smallestDisparity(const StereoGeometry& geometry) {
  return static_cast<int>(std::floor(geometry.principalPointDifference())) - kBelowZero_px;
}

/// The disparity of bit 0 of the sets, principal-point difference removed [px].
inline double firstDisparity(const StereoGeometry& geometry) {
  return smallestDisparity(geometry) - geometry.principalPointDifference();
}

/// A match far below zero is a wrong one: NaN; a little below it is as far as can be resolved.
inline float plausible(float disparity_px) {
  if (!(disparity_px >= -kLargestOffset_px)) return std::numeric_limits<float>::quiet_NaN();
  return std::max(disparity_px, kSmallestDisparity_px);
}

}  // namespace flight_corridor
