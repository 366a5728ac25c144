#pragma once

#include <stdexcept>
#include <string>

#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor {

/// What a device cannot do, or can no longer.
struct DeviceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Matches pairs, as SemiGlobalMatcher does, on another device than the CPU.
class DeviceMatcher {
 public:
  virtual ~DeviceMatcher() = default;
  virtual std::string name() const = 0;
  /// @throws DeviceError; out is then of no use.
  virtual void match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) = 0;
};

}  // namespace flight_corridor
