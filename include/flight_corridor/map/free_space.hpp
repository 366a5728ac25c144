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

/// The cubes of an octree that a depth image shows free: the rays that meet them end beyond them. Found coarse to fine
/// (after Reijgwart et al. 2023), by descending from the root only into cubes that may hold free cells.
class FreeSpace {
 public:
  static constexpr unsigned kBlockDepth = EvidenceTree::kDepth - 4;  ///< Of cubes searched by a thread each.

  /// Free children of a cube of the octree.
  struct FreeChildren {
    octomap::OcTreeKey key;  // of the cube's lowest cell
    unsigned depth;          // of the cube, 0 = root
    unsigned children;       // bit i: child i
  };

  using FreeCubes = std::vector<FreeChildren>;

  /// @param nearest_m depth of the nearest surface that would have been seen: nothing nearer is shown free.
  FreeSpace(const MapConfig& config, const StereoGeometry& geometry, double nearest_m);

  /// All free cells, by large cubes that hold nothing else; within a block by the largest.
  /// @param depth_m CV_32FC1 of geometry.size(), NaN = no ray.
  /// @return lists of neighbours; which threads found them makes no difference.
  const std::vector<FreeCubes>& find(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C);

 private:
  struct Parts;

  /// A cube of the octree, known to it or not.
  struct Cube {
    octomap::OcTreeKey key;    // of its lowest corner's cell
    unsigned depth;            // 0 = root
    Eigen::Vector3f centre_C;  // [m]
    float farthest_m;          // up to where one of its rays is free
  };

  /// Cubes of one depth, as C sees them.
  struct Orientation {
    Eigen::Vector3f reach;         // half extents of the box square to C around a cube [m]
    float x_m[8], y_m[8], z_m[8];  // from the centre of a cube to those of its eight parts
  };

  void orientCubes(const Eigen::Isometry3f& T_C_M);
  void findBelow(const Cube& cube, FreeCubes& free, std::vector<Cube>* blocks) const;
  unsigned descend(const Cube& cube, FreeCubes& free, std::vector<Cube>* blocks) const;
  void project(const Cube& cube, Parts& parts) const;
  void compareWithRays(int least_tiles, Parts& parts) const;
  int leastTilesOfCells(const Cube& cube) const;
  bool isBesideView(const Parts& parts, unsigned i, unsigned depth) const;
  float cellDepth() const { return 2.0f * orientations_.back().reach.z(); }  // of the box around a cell

  MapConfig config_;
  StereoGeometry geometry_;
  float nearest_m_;
  DepthPyramid pyramid_;
  std::array<Eigen::Vector3f, 4> view_sides_C_;  // outward normals of the planes through the image's borders
  std::array<Orientation, EvidenceTree::kDepth + 1> orientations_;  // per depth
  std::vector<Cube> blocks_;                                        // to be descended into side by side
  std::vector<FreeCubes> free_ = std::vector<FreeCubes>(1);         // above the blocks, then of each block
};

}  // namespace flight_corridor
