#pragma once

#include <Eigen/Geometry>
#include <memory_resource>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/hit_rule.hpp"
#include "flight_corridor/map/map_config.hpp"

namespace flight_corridor {

/// What one depth image shows of a box, cell by cell of a map: more exact than the cells are.
class SurfaceInBox {
 public:
  /// @param config of the map whose cells are asked for: a hit is the same here and there.
  /// @param depth_m CV_32FC1 of geometry.size(), depth along z of C [m], NaN = nothing; shared, not copied.
  /// @param scale_sigma one sigma of the depth's scale [-]; NaN or infinite: whole cells block.
  /// @param memory for scratch.
  SurfaceInBox(const MapConfig& config, const StereoGeometry& geometry, const cv::Mat& depth_m, double scale_sigma,
               const Eigen::Isometry3d& T_M_C, const Box& box,
               std::pmr::memory_resource* memory = std::pmr::get_default_resource());

  /// Where along the box's axis [m] the surface begins that fills an occupied cell, its nearest points left out as
  /// noise.
  /// @param near_m where the cell itself begins.
  /// @return +inf where the image shows what is in the cell, and nothing of it lies in the box or so little beside it
  /// that it may be in it; near_m where the image does not show that: then the cell is all that is known.
  double begin(const Eigen::Vector3d& cell_centre_M, double near_m);

 private:
  bool isShown(const Eigen::Vector3d& centre_C);
  cv::Rect pixels(const Eigen::Vector3d& cell_centre_C) const;
  bool isInCell(const Eigen::Vector3d& from_centre) const;
  bool isInBox(const Eigen::Vector3d& point_C) const;

  int min_hit_points_;
  double hit_band_px_, cell_m_;
  StereoGeometry geometry_;
  HitRule hit_rule_;
  cv::Mat depth_m_;
  double scale_sigma_;
  Eigen::Isometry3d T_M_C_, T_F_C_;
  Eigen::Vector3d box_size_m_, cell_reach_C_;  // half extents of the box square to C around a cell
  std::pmr::vector<double> begins_m_;          // scratch: of the cell's points in the box
};

}  // namespace flight_corridor
