#include "ros/free_areas_messages.hpp"

#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>

#include "flight_corridor/view/free_areas_view.hpp"
#include "flight_corridor/view/overlay.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::AreaGrid;
using flight_corridor::Box;
using flight_corridor::FreeArea;
using flight_corridor::State;
using visualization_msgs::Marker;

enum MarkerId { kTiles, kBest, kGoal };

constexpr float kTileAlpha = 0.85f, kUnknownAlpha = 0.45f, kRayAlpha = 0.12f;
constexpr double kLongestMarker_s = 60.0;  // ros::Duration holds no infinity

geometry_msgs::Vector3 toVector(const Eigen::Vector3d& vector) {
  geometry_msgs::Vector3 message;
  tf2::toMsg(vector, message);
  return message;
}

std_msgs::ColorRGBA colourOf(State state, float alpha) {
  const cv::Scalar bgr = flight_corridor::colour(state) / 255.0;
  std_msgs::ColorRGBA colour;
  colour.r = static_cast<float>(bgr[2]);
  colour.g = static_cast<float>(bgr[1]);
  colour.b = static_cast<float>(bgr[0]);
  colour.a = alpha;
  return colour;
}

Marker marker(const std_msgs::Header& header, MarkerId id, std::int32_t action) {
  Marker marker;
  marker.header = header;
  marker.ns = "free_areas";
  marker.id = id;
  marker.action = action;
  marker.pose.orientation.w = 1.0;
  return marker;
}

void addTriangle(Marker& tiles, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                 const std_msgs::ColorRGBA& colour) {
  for (const Eigen::Vector3d* corner : {&a, &b, &c}) {
    tiles.points.push_back(tf2::toMsg(*corner));
    tiles.colors.push_back(colour);
  }
}

/// A direction's tile and, if it is known, the ray of its width that leads to it.
void addArea(Marker& tiles, const FreeArea& area, const Box& box_C, double step_rad) {
  const double length_m = box_C.size_m.x();
  const bool is_blocked = area.verdict.state == State::Blocked, is_known = area.verdict.state != State::Unknown;
  const double reach_m = is_blocked ? std::clamp(area.verdict.clear_distance_m, 0.0, length_m) : length_m;
  const auto corners = tileOf(area, box_C, step_rad, reach_m);
  const auto solid = colourOf(area.verdict.state, is_known ? kTileAlpha : kUnknownAlpha);
  const auto faint = colourOf(area.verdict.state, is_known ? kRayAlpha : 0.0f);
  addTriangle(tiles, corners[0], corners[1], corners[2], solid);
  addTriangle(tiles, corners[0], corners[2], corners[3], solid);
  addTriangle(tiles, box_C.T_M_F.translation(), (corners[0] + corners[3]) / 2, (corners[1] + corners[2]) / 2, faint);
}

Marker arrow(Marker marker, const Eigen::Vector3d& from_C, const Eigen::Vector3d& to_C, double thickness_m) {
  marker.type = Marker::ARROW;
  marker.points = {tf2::toMsg(from_C), tf2::toMsg(to_C)};
  marker.scale.x = thickness_m;
  marker.scale.y = 2.5 * thickness_m;
  marker.scale.z = 4.0 * thickness_m;
  return marker;
}

}  // namespace

flight_corridor::FreeAreas toMessage(const std_msgs::Header& header, const AreaGrid& areas,
                                     const Eigen::Matrix3d& R_C_F, const std::optional<Eigen::Vector3d>& goal_C,
                                     const flight_corridor::SpeedConfig& speed, double latency_s) {
  flight_corridor::FreeAreas message;
  message.header = header;
  message.rows = static_cast<std::uint32_t>(areas.rows);
  message.columns = static_cast<std::uint32_t>(areas.columns);
  for (const FreeArea& area : areas.areas) {
    message.yaw.push_back(area.yaw_rad);
    message.pitch.push_back(area.pitch_rad);
    message.direction.push_back(toVector(R_C_F * ahead(area)));
    message.state.push_back(static_cast<std::uint8_t>(area.verdict.state));
    message.clear_distance.push_back(area.verdict.clear_distance_m);
    message.safe_speed.push_back(flight_corridor::safeSpeed(area.verdict.free_distance_m, latency_s, speed));
    message.reasons.push_back(area.verdict.reasons);
  }
  message.goal = toVector(goal_C.value_or(R_C_F.col(0)).normalized());
  message.best = areas.best;
  return message;
}

flight_corridor::FreeAreas toRefusal(const std_msgs::Header& header, const flight_corridor::FreeAreasConfig& config,
                                     std::uint32_t reasons) {
  AreaGrid areas = areaGrid(config);
  for (FreeArea& area : areas.areas) area.verdict.reasons = reasons;
  const Eigen::Matrix3d nowhere = Eigen::Matrix3d::Constant(flight_corridor::kNaN);
  return toMessage(header, areas, nowhere, std::nullopt, {}, 0.0);
}

visualization_msgs::MarkerArray toMarkers(const std_msgs::Header& header, const AreaGrid& areas, const Box& box_C,
                                          double step_rad, const std::optional<Eigen::Vector3d>& goal_C,
                                          double lifetime_s) {
  visualization_msgs::MarkerArray array;
  Marker tiles = marker(header, kTiles, Marker::ADD);
  tiles.type = Marker::TRIANGLE_LIST;
  tiles.scale.x = tiles.scale.y = tiles.scale.z = 1.0;
  tiles.color.a = 1.0f;
  for (const FreeArea& area : areas.areas) addArea(tiles, area, box_C, step_rad);
  array.markers.push_back(tiles);

  const Eigen::Vector3d from_C = box_C.T_M_F.translation();
  const double length_m = box_C.size_m.x();
  Marker best = marker(header, kBest, areas.best < 0 ? Marker::DELETE : Marker::ADD);
  if (areas.best >= 0) {
    const FreeArea& area = areas.areas[static_cast<std::size_t>(areas.best)];
    best = arrow(best, from_C, from_C + length_m * box_C.T_M_F.linear() * ahead(area), 0.06);
    best.color.r = best.color.g = best.color.b = best.color.a = 1.0f;
  }
  array.markers.push_back(best);

  Marker goal = marker(header, kGoal, goal_C ? Marker::ADD : Marker::DELETE);
  if (goal_C) {
    goal = arrow(goal, from_C, from_C + 1.1 * length_m * goal_C->normalized(), 0.03);
    goal.color.r = 0.1f;
    goal.color.g = 0.55f;
    goal.color.b = goal.color.a = 1.0f;
  }
  array.markers.push_back(goal);
  for (Marker& marker : array.markers) marker.lifetime = ros::Duration(std::min(lifetime_s, kLongestMarker_s));
  return array;
}

visualization_msgs::MarkerArray withoutMarkers(const std_msgs::Header& header) {
  visualization_msgs::MarkerArray array;
  for (const MarkerId id : {kTiles, kBest, kGoal}) array.markers.push_back(marker(header, id, Marker::DELETE));
  return array;
}

}  // namespace flight_corridor_ros
