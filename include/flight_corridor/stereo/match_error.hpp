#pragma once

namespace flight_corridor {

/// How matches err, in one place.
constexpr double kMatchNoise_px = 0.12;  ///< By so much a match may be nearer than it says: its sigma, averaged.
constexpr float kSameSurface_px = 1.0f;  ///< Neighbours of one surface differ by no more: noise and slope.
constexpr int kEdgeWidth_px = 9;         ///< Of what is matched along an edge: the census window's.

}  // namespace flight_corridor
