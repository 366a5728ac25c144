#pragma once

#include <memory>
#include <string>

#include "flight_corridor/stereo/semi_global_matcher.hpp"
#include "stereo/device_matcher.hpp"

namespace flight_corridor {

/// Semi-global matching by OpenCL on OpenCV's default device of the process (OPENCV_OPENCL_DEVICE chooses another): the
/// same bits as SemiGlobalMatcher. Kernels are compiled at construction, or come from OpenCV's cache; device memory,
/// 5 bytes a pixel and disparity and some, is taken there, too.
/// One object, one caller at a time.
class OpenClMatcher : public DeviceMatcher {
 public:
  /// @throws DeviceError naming what is missing: a device, memory, a compiler.
  explicit OpenClMatcher(const MatcherSize& size);
  ~OpenClMatcher() override;

  /// The device, its driver's version: "NVIDIA H100 PCIe (OpenCL 3.0 CUDA)".
  std::string name() const override;
  void match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) override;

  /// Whether the default device is a processor of the host; false without one.
  static bool isHostProcessor();

 private:
  struct Device;

  MatcherSize size_;
  std::unique_ptr<Device> device_;
};

}  // namespace flight_corridor
