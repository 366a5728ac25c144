#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor {

/// A device cannot match, or can no longer.
struct DeviceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Matches pairs like SemiGlobalMatcher, on another device than the CPU.
class DeviceMatcher {
 public:
  virtual ~DeviceMatcher() = default;
  virtual std::string name() const = 0;
  /// @throws DeviceError; out is then undefined.
  virtual void match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) = 0;
};

/// Makes one: null without a device. Empty: there is no way to one.
/// @throws DeviceError if there is one that cannot be used.
using DeviceMatcherFactory = std::function<std::unique_ptr<DeviceMatcher>(const MatcherSize&)>;

}  // namespace flight_corridor
