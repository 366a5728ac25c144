#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/cell_counts.hpp"
#include "flight_corridor/map/map_config.hpp"

namespace flight_corridor {

/// How many points of a depth image fall into each cell of an octree, in a window of cells around the camera.
class PointCounter {
 public:
  /// @throws std::invalid_argument if the window cannot hold what is in view up to max_range_m.
  PointCounter(const MapConfig& config, const StereoGeometry& geometry);

  /// Counts anew. Points beyond max_range_m are left out; all are where the camera is outside of what an octree holds.
  /// @param depth_m CV_32FC1 of geometry.size(), NaN = no point. Taken to be nearer by hit_band_px.
  void count(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C);

  /// By cubes of eight cells.
  const std::vector<CellCounts::Cube>& cubes() const { return points_.cubes(); }

  /// x, y, z of a cube's lowest cell in the octree: may be outside of what it holds.
  Eigen::Array3i lowestCell(const CellCounts::Cube& cube) const;

 private:
  void findCells(const float* depth_m, int v, const Eigen::Isometry3f& T_M_C);
  void findRuns();

  MapConfig config_;
  StereoGeometry geometry_;
  CellCounts points_;
  Eigen::Array3i window_key_{0, 0, 0};    // lowest cell of the window
  std::vector<std::uint32_t> row_cells_;  // scratch: cells of a row's points in the window
  std::vector<int> run_ends_;             // ... and where runs of one cell end
};

}  // namespace flight_corridor
