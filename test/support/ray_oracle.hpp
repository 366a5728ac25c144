#pragma once

#include <octomap/OcTreeKey.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <unordered_map>

#include "flight_corridor/map/occupancy_map.hpp"

namespace flight_corridor::test_support {

/// Depths as they are, for what is exact.
inline MapConfig withoutHitBand() {
  MapConfig config;
  config.hit_band_px = 0.0;
  return config;
}

enum class Cell { Unknown, Free, Occupied };

/// What one depth image says of every cell that a pixel's line touches, found
/// by the slow, obvious method: each line is walked from cell to cell, in double
/// precision. The rule is OccupancyMap's, said cell by cell:
/// - Occupied: the cell holds max(min_hit_points, hit_fraction * f^2 r^2 / Z^2)
/// points or more, Z the depth of its
///   centre, surfaces nearer by hit_band_px and within max_range_m.
/// - Free: not that; all of the cell lies on the image; every ray through it
/// ends beyond it, less free_band_px and
///   within max_range_m; at least min_ray_fraction of the pixels whose lines
///   touch it have a depth.
/// - Unknown: everything else.
class RayOracle {
 public:
  RayOracle(const MapConfig& config, const StereoGeometry& geometry) : config_(config), geometry_(geometry) {}

  /// What an image says into the map's frame M; what earlier ones said is
  /// forgotten.
  void look(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C) {
    cells_.clear();
    T_M_C_ = T_M_C;
    for (int v = 0; v < depth_m.rows; ++v) {
      for (int u = 0; u < depth_m.cols; ++u) {
        const double surface_m = depth_m.at<float>(v, u);
        walk(geometry_.point(u, v, 1.0), geometry_.shiftedDepth(surface_m, config_.free_band_px));
        const double hit_m = geometry_.shiftedDepth(surface_m, config_.hit_band_px);
        if (hit_m <= config_.max_range_m) ++cells_[keyOf(T_M_C * geometry_.point(u, v, hit_m))].points;
      }
    }
  }

  Cell at(const octomap::OcTreeKey& key) const {
    const auto found = cells_.find(key);
    if (found == cells_.end()) return Cell::Unknown;
    const Evidence& cell = found->second;
    if (cell.points >= pointsForHit(key)) return Cell::Occupied;
    const double rays = cell.passing, pixels = cell.passing + cell.blind;
    const bool seen_past = cell.ending == 0 && rays > 0.0;
    return seen_past && rays >= config_.min_ray_fraction * pixels && isWhollySeen(key) ? Cell::Free : Cell::Unknown;
  }

  /// Whether a ray ends in a cell or before it.
  bool endsRay(const octomap::OcTreeKey& key) const {
    const auto found = cells_.find(key);
    return found != cells_.end() && found->second.ending > 0;
  }

  /// Whether a cell and the six that share a face with it are free.
  bool isFreeWithin(const octomap::OcTreeKey& key) const {
    bool free = at(key) == Cell::Free;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int step : {-1, 1}) {
        octomap::OcTreeKey beside = key;
        beside[axis] = static_cast<octomap::key_type>(beside[axis] + step);
        free = free && at(beside) == Cell::Free;
      }
    }
    return free;
  }

  /// Calls back with the key of every cell that a line touches.
  template <typename Callback>
  void forEachCell(Callback&& callback) const {
    for (const auto& [key, evidence] : cells_) callback(key);
  }

 private:
  struct Evidence {
    int points = 0;   // surfaces in it
    int passing = 0;  // rays that end beyond it
    int ending = 0;   // rays that end in it or before it
    int blind = 0;    // pixels without depth
  };

  /// From the camera, cell by cell, to a little beyond what is used.
  void walk(const Eigen::Vector3d& ray_C, double free_up_to_m) {
    constexpr double kOver_m = 1e-6;  // into the next cell
    const double last_m = config_.max_range_m + config_.resolution_m;
    const Eigen::Vector3d ray_M = T_M_C_.linear() * ray_C;
    for (double z_m = 0.0; z_m < last_m;) {
      const octomap::OcTreeKey key = keyOf(T_M_C_.translation() + (z_m + kOver_m) * ray_M);
      z_m = std::max(z_m + kOver_m, exitDepth(key, ray_M));
      Evidence& cell = cells_[key];
      if (std::isnan(free_up_to_m)) {
        ++cell.blind;
      } else {
        ++(z_m <= std::min(free_up_to_m, config_.max_range_m) ? cell.passing : cell.ending);
      }
    }
  }

  /// Depth at which a line from the camera leaves a cell: where it meets the
  /// first of the cell's far faces.
  double exitDepth(const octomap::OcTreeKey& key, const Eigen::Vector3d& ray_M) const {
    double depth_m = kInfinity;
    for (int axis = 0; axis < 3; ++axis) {
      const double face_M = config_.resolution_m * (key[axis] - kKeyOrigin + (ray_M[axis] > 0.0 ? 1 : 0));
      if (ray_M[axis] != 0.0) depth_m = std::min(depth_m, (face_M - T_M_C_.translation()[axis]) / ray_M[axis]);
    }
    return depth_m;
  }

  octomap::OcTreeKey keyOf(const Eigen::Vector3d& p_M) const {
    const Eigen::Array3d cell = (p_M.array() / config_.resolution_m).floor() + kKeyOrigin;
    return {static_cast<octomap::key_type>(cell.x()), static_cast<octomap::key_type>(cell.y()),
            static_cast<octomap::key_type>(cell.z())};
  }

  Eigen::Vector3d inCamera(const octomap::OcTreeKey& key, const Eigen::Vector3d& from_corner) const {
    const Eigen::Vector3d corner(key[0] - kKeyOrigin, key[1] - kKeyOrigin, key[2] - kKeyOrigin);
    return T_M_C_.inverse() * (config_.resolution_m * (corner + from_corner));
  }

  double pointsForHit(const octomap::OcTreeKey& key) const {
    const double depth_m = inCamera(key, {0.5, 0.5, 0.5}).z();
    const StereoCalibration& camera = geometry_.calibration();
    const double face_px = camera.fx_px * camera.fy_px * std::pow(config_.resolution_m / depth_m, 2);
    return depth_m > 0.0 ? std::max<double>(config_.min_hit_points, config_.hit_fraction * face_px) : kInfinity;
  }

  bool isWhollySeen(const octomap::OcTreeKey& key) const {
    bool seen = true;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d from_corner(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
      seen = seen && geometry_.contains(geometry_.project(inCamera(key, from_corner)));
    }
    return seen;
  }

  static constexpr double kKeyOrigin = 32768.0;  // OctoMap's key of the coordinate 0
  MapConfig config_;
  StereoGeometry geometry_;
  Eigen::Isometry3d T_M_C_ = Eigen::Isometry3d::Identity();
  std::unordered_map<octomap::OcTreeKey, Evidence, octomap::OcTreeKey::KeyHash> cells_;
};

}  // namespace flight_corridor::test_support
