#pragma once

#include <string>

#include "ros/values.hpp"
#include "serial/protocol.hpp"
#include "serial/range_parser.hpp"

namespace flight_corridor_ros {

/// Parameters of range_serial; for "the sensor's" see serial::defaultsOf.
struct RangeSerialConfig {
  flight_corridor::serial::Protocol protocol{};  ///< `protocol`: lightware, tfmini or lidar_lite; required.
  std::string port = "/dev/ttyUSB0";
  int baud = 115200;
  std::string frame_id = "range_link";            ///< x along the beam.
  double field_of_view_rad = 0.0;                 ///< Full width of the beam; the sensor's.
  flight_corridor::serial::RangeLimits limits{};  ///< `min_range_m`, `max_range_m`, `strength_min`; the sensor's.
  std::string unit;  ///< Of the distances that the sensor sends; one of serial::unitsOf, by default the first.
  std::string wake;  ///< Sent when the port opens, to start the sensor: bytes as "0x5A 0x04", or a text with \r, \n.
  double request_hz = 0.0;  ///< How often a sensor is polled; 0: it sends by itself.
  double silence_s = 3.0;   ///< A warning comes after this long without a reading, or without a range in one.
};

/// Configuration with these values, the sensor's defaults elsewhere.
/// @throws std::invalid_argument listing every unknown key, wrong type and broken rule, with key, rule and value.
RangeSerialConfig makeRangeSerialConfig(const Values& values);

}  // namespace flight_corridor_ros
