#pragma once

#include <octomap/OcTree.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/occupancy_map.hpp"
#include "flight_corridor/view/cloud.hpp"

namespace flight_corridor_ros {

sensor_msgs::PointCloud2 toPointCloud(const std_msgs::Header& header, const flight_corridor::Cloud& cloud);

// Clouds by which costmap_2d's obstacle layer marks and clears. It uses a cloud's frame as the origin of ranges and
// rays, so both clouds are in the left camera's frame C; `header` is the left image's.

/// Centres of the occupied cells within a distance of the camera, large leaves cell by cell. Published even if empty:
/// the layer drops an observation only for a newer one.
sensor_msgs::PointCloud2 toObstacles(const std_msgs::Header& header, const octomap::OcTree& tree,
                                     const Eigen::Isometry3d& T_M_C, double max_range_m);

/// End points of clear rays: one per tile of the image in which enough pixels have a depth (map/min_ray_fraction), up
/// to the band before the nearest of them (map/free_band_px), at most map/max_range_m.
/// @param depth_m CV_32FC1, NaN = nothing.
sensor_msgs::PointCloud2 toClearing(const std_msgs::Header& header, const cv::Mat& depth_m,
                                    const flight_corridor::StereoGeometry& geometry,
                                    const flight_corridor::MapConfig& config);

}  // namespace flight_corridor_ros
