#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <opencv2/core/mat.hpp>

#include "flight_corridor/scale_correction.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

using Cloud = pcl::PointCloud<pcl::PointXYZI>;

struct CloudConfig {
  double max_range_m = 8.0;         ///< Points further are left out.
  int min_neighbours = 3;           ///< Of a pixel's 8 neighbours, those within 3 sigma_Z; fewer: noise.
  double disparity_sigma_px = 0.5;  ///< sigma_d of that sigma_Z.
};
Violations check(const CloudConfig& config);

/// Depth images and clouds in C from corrected disparity. One object, one thread.
class CloudBuilder {
 public:
  /// @throws std::invalid_argument with every broken rule.
  CloudBuilder(const CloudConfig& config, const StereoGeometry& geometry);

  /// Corrected depth along z of C.
  /// @param disparity_px CV_32FC1 of geometry.size(), NaN = nothing.  @param depth_m refilled: CV_32FC1 [m].
  void depth(const cv::Mat& disparity_px, const ScaleCorrection& correction, cv::Mat& depth_m) const;

  /// Cloud in C [m] of a depth image: noise removed, one point per voxel, intensity of the left image.
  /// @param depth_m CV_32FC1, NaN = nothing.  @param left CV_8UC1 of the same size.  @param voxel_m edge of a voxel.
  /// @param out refilled.
  void cloud(const cv::Mat& depth_m, const cv::Mat& left, double voxel_m, Cloud& out);

 private:
  bool isSupported(const cv::Mat& depth_m, int u, int v) const;

  CloudConfig config_;
  StereoGeometry geometry_;
  Cloud::Ptr dense_{new Cloud};  // scratch
};

}  // namespace flight_corridor
