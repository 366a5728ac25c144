#pragma once

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor::test_support {

inline const Box kCorridor{opticalFromForward(), {4.0, 1.2, 0.4}};  // as by default, in the camera
inline constexpr double kSmallest_m = 0.05;                         // obstacle
inline constexpr double kBlind_m = 0.4;                             // in front of the camera

}  // namespace flight_corridor::test_support
