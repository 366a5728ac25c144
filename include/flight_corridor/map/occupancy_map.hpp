#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <memory_resource>
#include <opencv2/core/mat.hpp>
#include <unordered_map>
#include <vector>

#include "flight_corridor/band_workers.hpp"
#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/evidence_tree.hpp"
#include "flight_corridor/map/free_space.hpp"
#include "flight_corridor/map/hit_rule.hpp"
#include "flight_corridor/map/map_config.hpp"
#include "flight_corridor/map/point_counter.hpp"

namespace flight_corridor {

/// Evidence of depth images and beams in an octomap::OcTree with log-odds (Hornung et al. 2013).
/// Frame M is the map's: W with odometry, C without. Cells behind surfaces and without data stay unknown.
class OccupancyMap {
 public:
  /// @param nearest_m depth of the nearest surface that would have been seen: a depth image frees nothing nearer.
  /// @throws std::invalid_argument with every broken rule.
  OccupancyMap(const MapConfig& config, const StereoGeometry& geometry, double nearest_m = 0.0);

  /// Hits: cells holding enough points for their distance. Misses: cells that the rays through them end beyond, coarse
  /// to fine, whole subtrees at once (after Reijgwart et al. 2023). Hits win over misses.
  /// @param depth_m CV_32FC1 of geometry.size(), depth along z of C [m], NaN = no ray.
  /// @param clears false: hits alone, for an image that may have lost something.
  void insert(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C, bool clears = true);

  /// One beam: misses from origin to end, and a hit in the end's cell.
  void insertBeam(const Eigen::Vector3d& origin_M, const Eigen::Vector3d& end_M);

  /// A window that moves with the camera: forgets what lies more than max_range_m beside centre_M on any axis and
  /// blocks of 16 x 16 x 16 cells without evidence for forget_s. Evidence added from now on is of stamp_s. For maps in
  /// a fixed frame.
  void keepAround(const Eigen::Vector3d& centre_M, double stamp_s);

  /// Everything unknown again.
  void clear();

  /// Cells that meet a box are unknown again; none where it is empty or NaN.
  void clear(const Eigen::AlignedBox3d& box_M);

  const octomap::OcTree& tree() const { return tree_; }

  /// A cell that holds points of the newest image.
  struct Seen {
    Eigen::Vector3d centre_M;
    float depth_m;
    std::uint32_t points;
    float face;  // the share of a full face's points that these are
    bool is_hit;
  };
  const std::vector<Seen>& seen() const { return seen_; }

  /// Whether the newest image shows something in a box that makes no hit: a cell centred there holds too many points
  /// to be mistakes.
  bool showsOutline(const Box& box_M) const;

 private:
  void addHits(const Eigen::Isometry3f& T_C_M);
  void addToChildren(const octomap::OcTreeKey& key, unsigned depth, unsigned children, double log_odds);
  void rememberBlocks(const octomap::OcTreeKey& key, unsigned depth, unsigned children);
  bool touches(const Eigen::AlignedBox3d& box_M, const octomap::OcTreeKey& block) const;

  MapConfig config_;
  EvidenceTree tree_;
  HitRule hit_rule_;
  PointCounter points_;
  FreeSpace free_space_;
  std::vector<Seen> seen_;
  octomap::KeyRay beam_;
  std::pmr::unsynchronized_pool_resource blocks_memory_;
  // Per block, by its lowest cell: stamp of its last evidence.
  std::pmr::unordered_map<std::uint64_t, double> seen_s_{&blocks_memory_};
  static constexpr std::uint64_t kNoBlock = ~std::uint64_t{0};
  std::uint64_t last_block_ = kNoBlock;  // noted last in seen_s_
  double now_s_ = 0.0;
  BandWorkers workers_{2};  // the caller, and one that counts points meanwhile
};

}  // namespace flight_corridor
