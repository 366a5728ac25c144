#pragma once

#include "flight_corridor/pipeline.hpp"

namespace flight_corridor::test_support {

/// The LiDAR in the camera's place.
inline Rig rigWithLidar() {
  Rig rig;
  rig.T_C_L = opticalFromForward();
  return rig;
}

inline RangeReading reading(double stamp_s, double range_m) { return {stamp_s, range_m, 0.2, 100.0, 0.03}; }

/// A box that starts so far ahead of the camera.
inline Box ahead(double from_m, double length_m) {
  Box box;
  box.T_M_F = opticalFromForward() * Eigen::Translation3d(from_m, 0.0, 0.0);
  box.size_m = {length_m, 0.6, 0.4};
  return box;
}

}  // namespace flight_corridor::test_support
