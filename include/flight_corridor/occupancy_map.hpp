#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core/mat.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "flight_corridor/depth_pyramid.hpp"
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
  double log_odds_miss = -0.7;    ///< Added for a miss.
  double log_odds_min = -2.0;     ///< Clamping limits.
  double log_odds_max = 3.5;
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

  /// Everything unknown again.
  void clear() { tree_.clear(); }

  const octomap::OcTree& tree() const { return tree_; }

 private:
  /// Access to the root, which OctoMap creates only through a point.
  class Tree : public octomap::OcTree {
   public:
    using octomap::OcTree::OcTree;
    octomap::OcTreeNode* makeRoot();
  };
  struct Cube;
  using CellCounts = std::unordered_map<octomap::OcTreeKey, int, octomap::OcTreeKey::KeyHash>;
  enum class Sight { Free, Nothing, Mixed };

  void measureRays(const cv::Mat& depth_m);
  void countPoints(const cv::Mat& depth_m, const Eigen::Isometry3f& T_M_C);
  void orientCubes(const Eigen::Isometry3f& T_C_M);
  bool visit(const Cube& cube);
  Sight look(const Cube& cube) const;
  bool isBesideView(const Cube& cube) const;
  bool isHit(const Cube& cube) const;
  octomap::OcTreeNode* materialise(unsigned depth, bool& created);
  void addToPath(unsigned depth, float log_odds);
  void addToSubtree(octomap::OcTreeNode* node, float log_odds);

  MapConfig config_;
  StereoGeometry geometry_;
  Tree tree_;
  Eigen::Array2f focal_px_, centre_px_;  // of the left image
  DepthPyramid pyramid_;
  cv::Mat hit_m_, near_m_, far_m_;  // per pixel: where its surface is, up to where its ray is surely free, and where
                                    // it ends at most
  CellCounts points_;
  std::array<Eigen::Vector3f, 4> view_sides_C_;  // outward normals of the planes through the image's borders
  std::vector<Eigen::Matrix3f> half_edges_C_;    // per tree depth: columns are the cube's half edges in C
  std::vector<Eigen::Array3f> cube_reach_C_;     // per tree depth: half extents of the box square to C around a cube
  std::vector<octomap::OcTreeNode*> path_;       // per tree depth: node of the cube being visited, null while unknown
  std::vector<unsigned> child_of_path_;          // per tree depth: which child of its parent that node is
  octomap::KeyRay beam_;
};

}  // namespace flight_corridor
