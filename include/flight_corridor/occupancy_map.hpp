#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core/mat.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "flight_corridor/cell_counts.hpp"
#include "flight_corridor/depth_pyramid.hpp"
#include "flight_corridor/evidence_tree.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

struct MapConfig {
  std::string frame_id;           ///< "" = camera frame, map built anew for each image; else the fixed frame, by tf.
  double resolution_m = 0.10;     ///< Edge of a cell.
  double max_range_m = 8.0;       ///< Depth up to which evidence is used.
  double hit_fraction = 0.15;     ///< A cell is hit by this share of the points that a full face would show there.
  int min_hit_points = 4;         ///< ... and by no fewer points than these.
  double hit_band_px = 0.1;       ///< Surfaces are taken to be nearer by this much disparity: one sigma of a match.
  double free_band_px = 0.5;      ///< Space within this much disparity before a surface is not cleared.
  double min_ray_fraction = 0.5;  ///< Share of a cell's pixels that must see past it to clear it.
  double log_odds_hit = 2.0;      ///< Added for a hit; one hit makes a cell occupied.
  double log_odds_miss = -1.1;    ///< Added for a miss; two make an occupied cell free.
  double log_odds_min = -2.0;     ///< Clamping limits.
  double log_odds_max = 2.0;
  double forget_s = 10.0;  ///< In a fixed frame: space without evidence for so long is unknown again.
};
Violations check(const MapConfig& config);

/// Evidence of depth images and beams in an octomap::OcTree with log-odds (Hornung et al. 2013).
/// Frame M is the map's: W with odometry, C without. Cells behind surfaces and without data stay unknown.
class OccupancyMap {
 public:
  /// @throws std::invalid_argument with every broken rule.
  OccupancyMap(const MapConfig& config, const StereoGeometry& geometry);

  /// Hits: cells holding enough points for their distance. Misses: cells that the rays through them end beyond, coarse
  /// to fine, whole subtrees at once (after Reijgwart et al. 2023). Hits win over misses.
  /// @param depth_m CV_32FC1 of geometry.size(), depth along z of C [m], NaN = no ray.
  void insert(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C);

  /// One beam: misses from origin to end, and a hit in the end's cell.
  /// @param hit false: nothing was met up to the end.
  void insertBeam(const Eigen::Vector3d& origin_M, const Eigen::Vector3d& end_M, bool hit);

  /// A window that moves with the camera: forgets what lies more than max_range_m beside centre_M on any axis and
  /// blocks of 16 x 16 x 16 cells without evidence for forget_s. Evidence added from now on is of stamp_s. For maps in
  /// a fixed frame.
  void keepAround(const Eigen::Vector3d& centre_M, double stamp_s);

  /// Everything unknown again.
  void clear();

  /// Cells that meet a box are unknown again.
  void clear(const Eigen::AlignedBox3d& box_M);

  const octomap::OcTree& tree() const { return tree_; }

 private:
  struct Cube;
  struct Parts;

  /// Cubes of one depth, as C sees them.
  struct Orientation {
    Eigen::Vector3f reach;         // half extents of the box square to C around a cube [m]
    float x_m[8], y_m[8], z_m[8];  // from the centre of a cube to those of its eight parts
  };

  void countPoints(const cv::Mat& depth_m, const Eigen::Isometry3f& T_M_C);
  void findCells(const float* depth_m, int v, const Eigen::Isometry3f& T_M_C);
  void findRuns();
  void addHits(const Eigen::Isometry3f& T_C_M);
  void orientCubes(const Eigen::Isometry3f& T_C_M);
  void addFree(const Cube& cube);
  void project(const Cube& cube, Parts& parts) const;
  bool isFree(const Parts& parts, unsigned i, unsigned depth) const;
  float cellDepth() const { return 2.0f * orientations_.back().reach.z(); }  // of the box around a cell
  bool isBesideView(const Parts& parts, unsigned i, unsigned depth) const;
  void addToChildren(const octomap::OcTreeKey& key, unsigned depth, unsigned children, double log_odds);
  void rememberBlocks(const octomap::OcTreeKey& key, unsigned depth, unsigned children);
  bool touches(const Eigen::AlignedBox3d& box_M, const octomap::OcTreeKey& block) const;

  MapConfig config_;
  StereoGeometry geometry_;
  EvidenceTree tree_;
  DepthPyramid pyramid_;
  CellCounts points_;
  Eigen::Array3i window_key_{0, 0, 0};           // lowest cell of the window in which points are counted
  std::vector<std::uint32_t> row_cells_;         // scratch: cells of a row's points in the window
  std::vector<int> run_ends_;                    // ... and where runs of one cell end
  std::array<Eigen::Vector3f, 4> view_sides_C_;  // outward normals of the planes through the image's borders
  std::vector<Orientation> orientations_;        // per tree depth
  octomap::KeyRay beam_;
  std::unordered_map<std::uint64_t, double> seen_s_;  // per block, by its lowest cell: stamp of its last evidence
  std::uint64_t last_block_ = 0;
  double now_s_ = 0.0;
};

}  // namespace flight_corridor
