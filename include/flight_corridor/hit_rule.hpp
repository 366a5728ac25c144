#pragma once

#include <cmath>
#include <cstdint>

#include "flight_corridor/map_config.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

/// What the points in a cell make of it, by its distance: a hit, if they are so many that speckles make none and thin
/// poles do; an outline; or too many to be mistakes.
class HitRule {
 public:
  HitRule(const MapConfig& config, const StereoCalibration& calibration)
      : min_points_(static_cast<std::uint32_t>(config.min_hit_points)),
        cell_px_m_(static_cast<float>(std::sqrt(calibration.fx_px * calibration.fy_px) * config.resolution_m)),
        hit_fraction_(static_cast<float>(config.hit_fraction)) {}

  /// @param depth_m of the cell's centre.
  bool isHit(std::uint32_t points, float depth_m) const { return isShare(hit_fraction_, points, depth_m); }

  /// What share of a full face's points these are: f^2 r^2 / Z^2.
  float face(std::uint32_t points, float depth_m) const {
    return static_cast<float>(points) * depth_m * depth_m / (cell_px_m_ * cell_px_m_);
  }

  /// Whether there are as many as an outline shows that crosses the cell: they grow with 1/Z where a face's grow with
  /// 1/Z^2, so that near the camera something bare, which has points on its outline alone, is no hit.
  bool isOutline(std::uint32_t points, float depth_m) const {
    return points >= min_points_ && static_cast<float>(points) * depth_m >= kOutline_px * cell_px_m_;
  }

  /// Whether there are too many to be mistakes.
  /// @param points of a cell and the 26 around it, without those that are hit.
  bool isScattered(std::uint32_t points, float depth_m) const { return isShare(kScattered, points, depth_m); }

 private:
  bool isShare(float share, std::uint32_t points, float depth_m) const {
    return points >= min_points_ && depth_m > 0.0f && face(points, depth_m) >= share;
  }

  static constexpr float kOutline_px = 1.5f;  // points across an outline: matching gives two or three
  static constexpr float kScattered = 0.25f;  // of a full face's; mistakes are fewer in nearly all images

  std::uint32_t min_points_;
  float cell_px_m_;  // edge of a cell in the image, times its depth
  float hit_fraction_;
};

}  // namespace flight_corridor
