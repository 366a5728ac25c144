#pragma once

namespace flight_corridor {

/// The errors of matches.
constexpr double kMatchNoise_px = 0.12;  ///< A match may be nearer by this: its averaged sigma.
constexpr float kSameSurface_px = 1.0f;  ///< Largest difference on one surface: noise and slope.
constexpr int kEdgeWidth_px = 9;         ///< Of matches along an edge: the census window's.

}  // namespace flight_corridor
