#pragma once

#include <cmath>

namespace flight_corridor {

/// The errors of matches.
constexpr double kMatchNoise_px = 0.12;  ///< A match may be nearer by this: its averaged sigma.
constexpr float kSameSurface_px = 1.0f;  ///< Largest difference on one surface: noise and slope.
constexpr int kEdgeWidth_px = 9;         ///< Of matches along an edge: the census window's.

/// Whether two corrected disparities may be of one surface; NaN is of none.
inline bool isOneSurface(double a_px, double b_px) { return std::abs(a_px - b_px) <= kSameSurface_px; }

}  // namespace flight_corridor
