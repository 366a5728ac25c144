#pragma once

#include <cstdint>

#include "flight_corridor/map_config.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

/// Whether points in a cell make it a hit: enough of them for its distance, so that speckles do not and thin poles do.
class HitRule {
 public:
  HitRule(const MapConfig& config, const StereoCalibration& calibration)
      : min_points_(static_cast<std::uint32_t>(config.min_hit_points)),
        enough_m2_(static_cast<float>(config.hit_fraction * calibration.fx_px * calibration.fy_px *
                                      config.resolution_m * config.resolution_m)) {}

  /// A full face shows f^2 r^2 / Z^2 points.
  /// @param depth_m of the cell's centre.
  bool isHit(std::uint32_t points, float depth_m) const {
    return points >= min_points_ && depth_m > 0.0f && static_cast<float>(points) * depth_m * depth_m >= enough_m2_;
  }

 private:
  std::uint32_t min_points_;
  float enough_m2_;
};

}  // namespace flight_corridor
