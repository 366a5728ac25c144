#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <sensor_msgs/LaserScan.h>
#include <std_msgs/Header.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "flight_corridor/corridor/free_areas.hpp"

namespace flight_corridor_ros {

// The level scan as messages for others. Its frames: CAMERA_scan at the left camera, x along the heading, z up, and
// CAMERA_scan_frd, the same with y right and z down. `camera` is the left image's header.

/// Both frames in the camera's.  @param R_C_H turns vectors of the scan's frame into C.
std::vector<geometry_msgs::TransformStamped> scanFrames(const std_msgs::Header& camera, const Eigen::Matrix3d& R_C_H);

/// REP-117: +inf if there is nothing up to range_max, NaN if that is not known. -inf does not occur: an obstacle nearer
/// than range_min counts at range_min.
sensor_msgs::LaserScan toScan(const std_msgs::Header& camera, const flight_corridor::LevelScan& scan);

/// For mavros' plugin obstacle_distance: the whole circle in 72 bins of 5 degrees, clockwise from ahead, as autopilots
/// expect. Free is range_max plus a centimetre; NaN (not known) are all bins out of view. In a bin the nearest obstacle
/// counts.
sensor_msgs::LaserScan toObstacleDistance(const std_msgs::Header& camera, const flight_corridor::LevelScan& scan);

}  // namespace flight_corridor_ros
