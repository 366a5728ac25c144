#pragma once

#include "flight_corridor/stereo/device_matcher.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor {

/// @throws DeviceError unless both find the same in a sample pair of this size: compilers of kernels make mistakes.
void requireSameMatches(DeviceMatcher& device, SemiGlobalMatcher& cpu, const MatcherSize& size);

}  // namespace flight_corridor
