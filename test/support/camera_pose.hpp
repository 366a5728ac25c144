#pragma once

#include "flight_corridor/motion/camera_motion.hpp"

namespace flight_corridor::test_support {

/// Of a camera that flies straight ahead.
inline CameraPose poseAt(double ahead_m, int series = 1) {
  CameraPose pose;
  pose.T_M_C.translation().z() = ahead_m;
  pose.series = series;
  return pose;
}

}  // namespace flight_corridor::test_support
