#pragma once

#include <string>

namespace flight_corridor_ros {

/// How a stamp stands to the clock: "0.610 s old", "stamped 3600.000 s (1.0 h) ahead of the clock".
/// @param age_s the clock less the stamp.
std::string describeAge(double age_s);

/// What to do about a stamp that is out of date: clocks that differ by whole half hours are set to different zones.
std::string clockRemedy(double age_s);

}  // namespace flight_corridor_ros
