#pragma once

#include <sensor_msgs/LaserScan.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace flight_corridor_ros::test_support {

/// MAVLink's OBSTACLE_DISTANCE, the fields that autopilots read.
struct ObstacleDistance {
  std::array<std::uint16_t, 72> distances{};
  std::uint16_t min_distance = 0, max_distance = 0;  // [cm]
  float increment_f = 0.0f, angle_offset = 0.0f;     // [deg], clockwise
};

constexpr std::uint16_t kNotKnown = 65535;

/// What mavros' plugin obstacle_distance sends of a scan with no more than 72 ranges: whole centimetres rounded down,
/// NaN, infinity and negative ranges not known, angles in degrees.
inline ObstacleDistance asMavrosSends(const sensor_msgs::LaserScan& scan) {
  ObstacleDistance message;
  message.distances.fill(kNotKnown);
  for (std::size_t i = 0; i < scan.ranges.size() && i < message.distances.size(); ++i) {
    const float cm = static_cast<float>(scan.ranges[i] * 100.0);
    if (0.0f <= cm && cm < 65535.0f) message.distances[i] = static_cast<std::uint16_t>(cm);
  }
  message.min_distance = static_cast<std::uint16_t>(scan.range_min * 100.0);
  message.max_distance = static_cast<std::uint16_t>(scan.range_max * 100.0);
  message.increment_f = static_cast<float>(scan.angle_increment * (180.0 / M_PI));
  message.angle_offset = static_cast<float>(scan.angle_min * (180.0 / M_PI));
  return message;
}

/// Which entry PX4's collision prevention reads for its own bin, 5 degrees wide, in frame BODY_FRD: rounded up.
inline int entryOfPx4Bin(int bin, const ObstacleDistance& message) {
  const float ahead_deg = 5.0f * static_cast<float>(bin) - message.angle_offset;
  const float wrapped_deg = std::fmod(ahead_deg + 360.0f, 360.0f);
  return static_cast<int>(std::ceil(wrapped_deg * (1.0f / message.increment_f)));
}

/// Whether ArduPilot takes an entry for an obstacle; it ignores all others.
inline bool isObstacleForArduPilot(std::uint16_t distance_cm, const ObstacleDistance& message) {
  return distance_cm != 0 && distance_cm != kNotKnown && message.min_distance <= distance_cm &&
         distance_cm <= message.max_distance;
}

}  // namespace flight_corridor_ros::test_support
