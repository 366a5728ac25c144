#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "flight_corridor/corridor/free_areas.hpp"
#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

/// Corners of a direction's tile, as wide as its step less a gap: the end of its box at a distance, in C.
/// @param box_C the corridor's, with M = C.
std::vector<Eigen::Vector3d> tileOf(const FreeArea& area, const Box& box_C, double step_rad, double distance_m);

/// The directions on the left image: a tile each at the end of its box, green free, red blocked (the middle row shows
/// the distance [m]), amber unknown. The best one has a white ring; a blue diamond marks the wanted direction.
/// @param left  CV_8UC1 or CV_8UC3 (BGR).   @param box_C  the corridor's, with M = C.
/// @param goal_C wanted direction, of any length; absent: straight ahead, without a mark.
/// @param out   CV_8UC3 (BGR), refilled, same size.
void drawFreeAreas(const cv::Mat& left, const StereoGeometry& geometry, const Box& box_C, const AreaGrid& areas,
                   double step_rad, const std::optional<Eigen::Vector3d>& goal_C, cv::Mat& out);

}  // namespace flight_corridor
