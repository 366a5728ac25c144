#pragma once

#include <limits>

namespace flight_corridor::serial {

/// The content of one frame or line of a LiDAR, before the sensor's limits are applied.
struct Measurement {
  /// [m] REP-117: +inf no return, NaN invalid according to the sensor.
  double range_m = std::numeric_limits<double>::quiet_NaN();
  /// In the sensor's own unit; NaN: not given.
  double strength = std::numeric_limits<double>::quiet_NaN();
  /// Error code in place of a distance, e.g. -3; NaN: no error.
  double error_code = std::numeric_limits<double>::quiet_NaN();
  /// What the code means, with the remedy, as its sensors' manual says; "": it does not.
  const char* error = "";
};

/// A frame or line, read.
struct Parsed {
  enum class Outcome { Valid, Malformed, WrongChecksum };
  Outcome outcome = Outcome::Malformed;
  Measurement measurement;
};

}  // namespace flight_corridor::serial
