#pragma once

#include <string_view>

#include "serial/measurement.hpp"

namespace flight_corridor::serial {

/// Reads a line of arduino/lidar_lite:
///   R,<cm>,<strength>*<checksum>   a measurement; without <cm> there was no return
///   E*<checksum>                   the LIDAR-Lite does not answer the Arduino
/// Whole numbers; strength is the sensor's register 0x0e, 0 to 255. The checksum is NMEA 0183's: two hexadecimal
/// digits of the exclusive or of all characters before the star.
Parsed parseLidarLite(std::string_view line);

}  // namespace flight_corridor::serial
