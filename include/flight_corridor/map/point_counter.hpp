#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <unordered_map>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/map/map_config.hpp"

namespace flight_corridor {

/// Points in each cell of an octree.
using PointCounts = std::unordered_map<octomap::OcTreeKey, std::uint32_t, octomap::OcTreeKey::KeyHash>;

/// Counts the points of a depth image in each cell, without those beyond max_range_m or outside the octree.
/// @param depth_m CV_32FC1 of geometry.size(), NaN = no point. Points are moved nearer by hit_band_px.
PointCounts countPoints(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C, const StereoGeometry& geometry,
                        const MapConfig& config);

}  // namespace flight_corridor
