#pragma once

#include <functional>
#include <memory>
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

/// Makes one: null without a device.
/// @throws DeviceError when there is one that cannot be used.
using DeviceMatcherFactory = std::function<std::unique_ptr<DeviceMatcher>(const MatcherSize&)>;

/// By OpenCL, on a GPU or what OPENCV_OPENCL_DEVICE names.
std::unique_ptr<DeviceMatcher> makeOpenClMatcher(const MatcherSize& size);

}  // namespace flight_corridor
