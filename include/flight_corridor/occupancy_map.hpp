#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <octomap/OcTree.h>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/cloud_builder.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

struct MapConfig {
  std::string frame_id;              ///< "" = camera frame, map built anew for each image; else the fixed frame, by tf.
  double resolution_m = 0.10;        ///< Edge of a cell.
  double max_range_m = 8.0;          ///< Depth up to which evidence is used.
  double hit_fraction = 0.15;        ///< A cell is hit by this share of the points that a full face would show there.
  int min_hit_points = 4;            ///< ... and by no fewer points than these.
  double free_band_sigma = 2.0;      ///< Space nearer than this many sigma_Z before a surface is not cleared.
  double disparity_sigma_px = 0.5;   ///< sigma_d of that sigma_Z.
  double min_ray_fraction = 0.5;     ///< Share of a cell's pixels that must see past it to clear it.
  double log_odds_hit = 2.0;         ///< Added for a hit; one hit makes a cell occupied.
  double log_odds_miss = -0.7;       ///< Added for a miss.
  double log_odds_min = -2.0;        ///< Clamping limits.
  double log_odds_max = 3.5;
};
Violations check(const MapConfig& config);

/// Evidence of depth images and beams in an octomap::OcTree with log-odds (Hornung et al. 2013).
/// Frame M is the map's: W with odometry, C without. Cells behind surfaces and without data stay unknown.
class OccupancyMap {
 public:
  /// @throws std::invalid_argument with every broken rule.
  OccupancyMap(const MapConfig& config, const StereoGeometry& geometry);

  /// Hits: cells holding enough points of either image for their distance. Misses: cells that all rays through them end
  /// beyond, coarse-to-fine. Hits win over misses.
  /// @param depth  both images of geometry.size(), depth along z of C [m], NaN = no ray.
  void insert(const DepthImages& depth, const Eigen::Isometry3d& T_M_C);

  /// One beam: misses from origin to end, and a hit in the end's cell.
  /// @param hit false: nothing met at the end (the beam is cut at max_range_m).
  void insertBeam(const Eigen::Vector3d& origin_M, const Eigen::Vector3d& end_M, bool hit);

  /// Everything unknown again.
  void clear();

  const octomap::OcTree& tree() const { return tree_; }

 private:
  MapConfig config_;
  StereoGeometry geometry_;
  octomap::OcTree tree_;
};

}  // namespace flight_corridor
