#pragma once

#include <memory>

#include "flight_corridor/stereo/device_matcher.hpp"

namespace flight_corridor {

/// By OpenCL, on a GPU or the device that OPENCV_OPENCL_DEVICE names; null without one.
/// @throws DeviceError if there is one that cannot be used.
std::unique_ptr<DeviceMatcher> makeOpenClMatcher(const MatcherSize& size);

}  // namespace flight_corridor
