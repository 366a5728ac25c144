#pragma once

#include <octomap/OcTree.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/occupancy_map.hpp"

namespace flight_corridor_ros {

// What costmap_2d's obstacle layer marks and clears by. It takes a cloud's frame for the sensor that its ranges and
// rays begin at, so that both clouds are in the left camera's frame C; `header` is the left image's.

/// Centres of the occupied cells within a distance of the camera, large leaves cell by cell. Empty when there is none:
/// the layer forgets an obstacle's observation only for another.
sensor_msgs::PointCloud2 toObstacles(const std_msgs::Header& header, const octomap::OcTree& tree,
                                     const Eigen::Isometry3d& T_M_C, double max_range_m);

/// Ends of rays along which nothing stands: one for each tile of the image in which enough pixels have a depth
/// (map/min_ray_fraction), the band before the nearest of them left out (map/free_band_px), up to map/max_range_m.
/// @param depth_m CV_32FC1, NaN = nothing.
sensor_msgs::PointCloud2 toClearing(const std_msgs::Header& header, const cv::Mat& depth_m,
                                    const flight_corridor::StereoGeometry& geometry,
                                    const flight_corridor::MapConfig& config);

}  // namespace flight_corridor_ros
