#pragma once

#include <nav_msgs/OccupancyGrid.h>
#include <octomap/OcTree.h>
#include <octomap_msgs/BoundingBoxQuery.h>
#include <octomap_msgs/Octomap.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <Eigen/Geometry>

namespace flight_corridor_ros {

// The octree in octomap_server's messages. `header` is the map's; T_M_G turns a frame G with z up at the map's origin
// into the map's frame M (identity for a fixed frame, opticalFromForward() for the camera's).

/// @throws std::invalid_argument unless both corners are finite and max is nowhere below min.
Eigen::AlignedBox3d toBox(const octomap_msgs::BoundingBoxQueryRequest& request);

/// Free, occupied and unknown only.
octomap_msgs::Octomap toBinaryOctomap(const std_msgs::Header& header, const octomap::OcTree& tree);
/// The cells' log-odds.
octomap_msgs::Octomap toFullOctomap(const std_msgs::Header& header, const octomap::OcTree& tree);

enum class Cells { Occupied, Free };

/// One cube list per depth of the tree: id = depth, empty lists delete theirs. Occupied cells are coloured by height.
visualization_msgs::MarkerArray toMarkers(const std_msgs::Header& header, const octomap::OcTree& tree, Cells cells,
                                          const Eigen::Isometry3d& T_M_G);

/// Centres of the occupied cells.
sensor_msgs::PointCloud2 toCellCentres(const std_msgs::Header& header, const octomap::OcTree& tree);

/// Columns seen from above: 100 if any cell is occupied, else 0 if any is free, else -1. For a map whose z is up: users
/// assume that a grid is level.
nav_msgs::OccupancyGrid toProjectedMap(const std_msgs::Header& header, const octomap::OcTree& tree);

}  // namespace flight_corridor_ros
