#pragma once

#include <cmath>
#include <cstdint>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/map_config.hpp"

namespace flight_corridor {

/// Whether the points in a cell make a hit: by its distance so many that speckles make none and thin poles do.
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

  /// What share of a full face's points these are: f^2 r^2 / Z^2.
  float face(std::uint32_t points, float depth_m) const {
    return static_cast<float>(points) * depth_m * depth_m / (cell_px_m_ * cell_px_m_);
  }

 private:
  std::uint32_t min_points_;
  float cell_px_m_;  // edge of a cell in the image, times its depth
  float hit_fraction_;
};

}  // namespace flight_corridor
