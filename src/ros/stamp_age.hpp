#pragma once

#include <string>

namespace flight_corridor_ros {

/// A stamp relative to the clock: "0.610 s old", "stamped 3600.000 s (1.0 h) ahead of the clock".
/// @param age_s the clock less the stamp.
std::string describeAge(double age_s);

/// Remedy for an outdated stamp: clocks that differ by a multiple of half an hour are set to different zones.
std::string clockRemedy(double age_s);

}  // namespace flight_corridor_ros
