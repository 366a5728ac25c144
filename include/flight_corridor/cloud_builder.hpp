#pragma once

#include <opencv2/core/mat.hpp>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "flight_corridor/disparity_estimator.hpp"
#include "flight_corridor/scale_correction.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

using Cloud = pcl::PointCloud<pcl::PointXYZI>;

struct CloudConfig {
  double max_range_m = 8.0;            ///< Points further are left out.
  int min_neighbours = 3;              ///< Of a pixel's 8 neighbours, those within 3 sigma_Z; fewer: noise.
  double disparity_sigma_px = 0.5;     ///< sigma_d of that sigma_Z.
};
Violations check(const CloudConfig& config);

/// Depth images and clouds in C from corrected disparity.
struct DepthImages {
  cv::Mat matched_m;   ///< CV_32FC1, from Disparity::matched_px: the evidence. NaN = nothing.
  cv::Mat filled_m;    ///< CV_32FC1, from Disparity::filtered_px. NaN = nothing.
};

class CloudBuilder {
 public:
  /// @throws std::invalid_argument with every broken rule.
  CloudBuilder(const CloudConfig& config, const StereoGeometry& geometry);

  /// Corrected depth of both disparities, lone pixels of the matched one removed.
  void depth(const Disparity& disparity, const ScaleCorrection& correction, DepthImages& out);

  /// Cloud in C [m] of a depth image, intensity from the left image, one point per voxel.
  /// @param voxel_m edge of the voxel grid.
  void cloud(const cv::Mat& depth_m, const cv::Mat& left, double voxel_m, Cloud& out);

 private:
  CloudConfig config_;
  StereoGeometry geometry_;
  cv::Mat scratch_;
};

}  // namespace flight_corridor
