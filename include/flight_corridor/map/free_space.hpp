#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/depth_pyramid.hpp"
#include "flight_corridor/map/evidence_tree.hpp"
#include "flight_corridor/map/map_config.hpp"

namespace flight_corridor {

/// The cubes of an octree that a depth image shows free: the rays through them end beyond them. Found coarse to fine
/// (after Reijgwart et al. 2023), descending from the root only into cubes that may hold free cells.
class FreeSpace {
 public:
  /// A cube of the octree.
  struct Cube {
    octomap::OcTreeKey key;  // of its lowest cell
    unsigned depth;          // 0 = root
  };

  /// @param nearest_m depth of the nearest surface that would have been seen: nothing nearer is shown free.
  FreeSpace(const MapConfig& config, const StereoGeometry& geometry, double nearest_m);

  /// All free cells, as the largest cubes that hold only free cells.
  /// @param depth_m CV_32FC1 of geometry.size(), NaN = no ray.
  const std::vector<Cube>& find(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C);

 private:
  /// Part of the image, borders included [px].
  struct Area {
    float left, top, right, bottom;
  };

  bool findIn(const Cube& cube, const Eigen::Vector3f& centre_C);
  bool findInChildren(const Cube& cube, const Eigen::Vector3f& centre_C);
  Area project(const Eigen::Vector3f& centre_C, const Eigen::Vector3f& reach) const;
  cv::Rect tilesOf(const Area& area) const;
  int leastTilesOfCells(float far_m) const;
  const Eigen::Vector3f& reachOfCells() const { return reach_.back(); }

  MapConfig config_;
  StereoGeometry geometry_;
  float nearest_m_;
  DepthPyramid pyramid_;
  // Of cubes, per depth: half extents of the box square to C around one [m], and half its edges in C.
  std::array<Eigen::Vector3f, EvidenceTree::kDepth + 1> reach_;
  std::array<Eigen::Matrix3f, EvidenceTree::kDepth + 1> half_edges_C_;
  std::vector<Cube> free_;
};

}  // namespace flight_corridor
