#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "flight_corridor/pipeline.hpp"

namespace flight_corridor {

using Cloud = pcl::PointCloud<pcl::PointXYZI>;

/// Cloud in C [m] of a depth image: noise removed, one point per voxel, intensity of the left image.
/// @param depth_m CV_32FC1, NaN = nothing.  @param left CV_8UC1 of the same size.  @param voxel_m edge of a voxel.
Cloud toCloud(const cv::Mat& depth_m, const cv::Mat& left, const StereoGeometry& geometry, const CloudConfig& config,
              double voxel_m);

/// The cloud of the last frame's evidence, a point per cell of the map; empty before the first frame.
Cloud toCloud(const Pipeline& pipeline);

}  // namespace flight_corridor
