#pragma once

#include <flight_corridor/FreeAreas.h>
#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <Eigen/Core>
#include <optional>

#include "flight_corridor/corridor/free_areas.hpp"
#include "flight_corridor/corridor/safe_speed.hpp"
#include "flight_corridor/geometry/box.hpp"

namespace flight_corridor_ros {

/// The free directions.  @param header the left image's.  @param R_C_F of the corridor's frame.
/// @param goal_C wanted direction; absent: ahead.  @param latency_s from the left image's stamp to now.
flight_corridor::FreeAreas toMessage(const std_msgs::Header& header, const flight_corridor::AreaGrid& areas,
                                     const Eigen::Matrix3d& R_C_F, const std::optional<Eigen::Vector3d>& goal_C,
                                     const flight_corridor::SpeedConfig& speed, double latency_s);

/// The same for a refused or missing pair: nothing is known in any direction, nor where the directions point.
flight_corridor::FreeAreas toRefusal(const std_msgs::Header& header, const flight_corridor::FreeAreasConfig& config,
                                     std::uint32_t reasons);

/// For rviz, in C: a tile per direction at the end of its box (green: free, faint amber: not known), or at its obstacle
/// (red); a white arrow along the best one, a blue one along the goal.
/// @param box_C the corridor's, with M = C.  @param lifetime_s after which they vanish from the screen.
visualization_msgs::MarkerArray toMarkers(const std_msgs::Header& header, const flight_corridor::AreaGrid& areas,
                                          const flight_corridor::Box& box_C, double step_rad,
                                          const std::optional<Eigen::Vector3d>& goal_C, double lifetime_s);

/// Removes them from the screen.
visualization_msgs::MarkerArray withoutMarkers(const std_msgs::Header& header);

}  // namespace flight_corridor_ros
