#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <unordered_map>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/evidence_tree.hpp"
#include "flight_corridor/map/map_config.hpp"

namespace flight_corridor {

/// What a depth image says of the map's cells. A cell is hit by enough points for its distance, so that thin poles make
/// a hit and speckles do not: n points show the share n Z^2 / (f^2 r^2) of a full face. It is free if all rays through
/// it end beyond it: its far side is compared with the least depth of tiles of pixels about its image.
class CellEvidence {
 public:
  static constexpr int kTile_px = 4;  ///< Edge of the squares in which depth is compared.

  /// @param nearest_m depth of the nearest surface that would have been seen: nothing nearer is free.
  CellEvidence(const MapConfig& config, const StereoGeometry& geometry, double nearest_m);

  /// @param depth_m CV_32FC1 of geometry.size(), NaN = no ray.
  /// @param clears false: nothing is free.
  void look(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C, bool clears = true);

  /// @param block its lowest cell.
  /// @param log_odds of a hit or a miss in each cell, 0 = no evidence.
  /// @return whether there is any.
  bool find(const octomap::OcTreeKey& block, EvidenceTree::Block<float>& log_odds);

 private:
  using Points =
      std::unordered_map<octomap::OcTreeKey, EvidenceTree::Block<std::uint32_t>, octomap::OcTreeKey::KeyHash>;
  static constexpr int kCells = static_cast<int>(EvidenceTree::Block<float>().size());
  template <int kColumns>
  using Columns = Eigen::Array<float, kCells, kColumns>;

  void countPoints(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C);
  void findLeast(const cv::Mat& depth_m);
  bool isHit(std::uint32_t points, float depth_m) const;
  bool isInView(const Eigen::Vector3f& corner) const;
  void project(const Eigen::Vector3f& corner);
  bool isFree(int cell);
  void addLargerSquares();

  MapConfig config_;
  StereoGeometry geometry_;
  float nearest_m_, farthest_m_ = 0.0f;
  double min_rays_;  // of a tile
  bool clears_ = true;
  Points points_;                   // in each cell of the blocks that hold points
  std::vector<cv::Mat1f> least_m_;  // [side - 1](row, column): the shortest free ray of a square of tiles from there on
  cv::Mat1i rays_sum_;              // rays of the tiles above and left
  // In P, the camera's frame with x and y times the focal length, so that x / z and y / z are tiles:
  Eigen::Array3f centre_, last_;  // principal point and last pixel [tiles]
  Eigen::Matrix<double, 3, 4> T_P_M_;
  Eigen::Vector3f reach_;  // half extents of the box around a cell that is square to C
  Columns<3> cells_;       // centres of cells, from the lowest corner of their block
  // Of a block's cells: bounds of their boxes' images [tiles], and how far in view and range they are, negative: not.
  Columns<2> low_, high_;
  Columns<1> far_m_, per_near_, per_far_, inside_;
};

}  // namespace flight_corridor
