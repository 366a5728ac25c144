#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <unordered_map>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/cell_evidence.hpp"
#include "flight_corridor/map/evidence_tree.hpp"
#include "flight_corridor/map/map_config.hpp"

namespace flight_corridor {

/// Evidence of depth images and beams in an octomap::OcTree with log-odds (Hornung et al. 2013).
/// Frame M is the map's: W with odometry, C without. Cells behind surfaces and without data stay unknown.
class OccupancyMap {
 public:
  /// @param nearest_m depth of the nearest surface that would have been seen: a depth image clears nothing nearer.
  /// @throws std::invalid_argument with every broken rule.
  OccupancyMap(const MapConfig& config, const StereoGeometry& geometry, double nearest_m = 0.0);

  /// Hits: cells with enough points for their distance. Misses: cells beyond which all rays through them end.
  /// @param depth_m CV_32FC1 of geometry.size(), depth along z of C [m], NaN = no ray.
  /// @param clears false: only hits, for an image that may have missed obstacles.
  void insert(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C, bool clears = true);

  /// One beam: misses from origin to end, and a hit in the end's cell; nothing where one of them has no key.
  void insertBeam(const Eigen::Vector3d& origin_M, const Eigen::Vector3d& end_M);

  /// A window that moves with the camera: forgets cells more than max_range_m from centre_M on any axis, and blocks of
  /// 16 x 16 x 16 cells without evidence for forget_s. Later evidence gets stamp_s. For maps in a fixed frame.
  void keepAround(const Eigen::Vector3d& centre_M, double stamp_s);

  /// Makes everything unknown.
  void clear();

  /// Makes the cells that meet a box unknown; no cell if it is empty or NaN.
  void clear(const Eigen::AlignedBox3d& box_M);

  const octomap::OcTree& tree() const { return tree_; }

 private:
  void add(const octomap::OcTreeKey& cell, bool is_hit);
  octomap::OcTreeKey cellOf(const Eigen::Vector3d& p_M) const;
  bool touches(const Eigen::AlignedBox3d& box_M, const octomap::OcTreeKey& block) const;

  MapConfig config_;
  StereoGeometry geometry_;
  EvidenceTree tree_;
  CellEvidence evidence_;
  octomap::KeyRay beam_;
  // Per block, by its lowest cell: stamp of its last evidence.
  std::unordered_map<octomap::OcTreeKey, double, octomap::OcTreeKey::KeyHash> seen_s_;
  double now_s_ = 0.0;
};

}  // namespace flight_corridor
