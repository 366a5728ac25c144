#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "flight_corridor/stereo/device_matcher.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor {

/// Semi-global matching by OpenCL on OpenCV's default device of the process, a GPU, or what OPENCV_OPENCL_DEVICE names:
/// the same evidence as SemiGlobalMatcher's. Kernels are compiled at construction, or come from OpenCV's cache; device
/// memory is 5 bytes a pixel and disparity, and some.
/// One object, one caller at a time.
class OpenClMatcher : public DeviceMatcher {
 public:
  /// @throws DeviceError naming what is missing: a device, memory, a compiler.
  explicit OpenClMatcher(const MatcherSize& size);
  ~OpenClMatcher() override;

  /// Whether OpenCV has found a device.
  static bool hasDevice();

  std::string name() const override;
  void match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) override;

 private:
  struct Device;

  std::uint32_t pairs_ = 0;
  std::unique_ptr<Device> device_;
};

}  // namespace flight_corridor
