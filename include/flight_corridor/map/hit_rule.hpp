#pragma once

#include <cmath>
#include <cstdint>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/map_config.hpp"

namespace flight_corridor {

/// Whether the points in a cell are a hit: the number depends on distance, so that thin poles make a hit and speckles
/// do not.
class HitRule {
 public:
  HitRule(const MapConfig& config, const StereoCalibration& calibration)
      : min_points_(static_cast<std::uint32_t>(config.min_hit_points)),
        cell_px_m_(static_cast<float>(std::sqrt(calibration.fx_px * calibration.fy_px) * config.resolution_m)),
        hit_fraction_(static_cast<float>(config.hit_fraction)) {}

  /// @param depth_m of the cell's centre.
  bool isHit(std::uint32_t points, float depth_m) const {
    return points >= min_points_ && depth_m > 0.0f && face(points, depth_m) >= hit_fraction_;
  }

  /// Share of the points of a full face, f^2 r^2 / Z^2.
  float face(std::uint32_t points, float depth_m) const {
    return static_cast<float>(points) * depth_m * depth_m / (cell_px_m_ * cell_px_m_);
  }

 private:
  std::uint32_t min_points_;
  float cell_px_m_;  // edge of a cell in the image, times its depth
  float hit_fraction_;
};

}  // namespace flight_corridor
