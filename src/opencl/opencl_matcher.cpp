#include "flight_corridor/opencl/opencl_matcher.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/ocl.hpp>
#include <string>
#include <vector>

#include "opencl/kernel_source.hpp"
#include "opencl/kernels.hpp"

namespace flight_corridor {

namespace {

/// OpenCV's errors as DeviceError.
template <class Job>
auto onDevice(Job&& job) {
  try {
    return job();
  } catch (const cv::Exception& error) {
    throw DeviceError("OpenCL: " + error.err);
  }
}

void requireLocalMemory(const MatcherSize& size) {
  const std::size_t needed = opencl::localMemory(size), available = cv::ocl::Device::getDefault().localMemSize();
  if (needed <= available) return;
  throw DeviceError("OpenCL: so wide an image needs " + std::to_string(needed) +
                    " bytes of local memory, the device has " + std::to_string(available));
}

cv::ocl::Program compile(const MatcherSize& size) {
  requireLocalMemory(size);
  const cv::ocl::ProgramSource source("flight_corridor", "semi_global_matcher", opencl::kKernelSource, "");
  cv::String errors;
  const cv::ocl::Program program = cv::ocl::Context::getDefault().getProg(source, opencl::kernelOptions(size), errors);
  if (program.ptr() != nullptr) return program;
  throw DeviceError("OpenCL: the kernels cannot be compiled: " + errors.substr(0, errors.find('\n')));
}

/// A view of what the device's memory is copied from or to.
cv::Mat rows(const void* bytes, int height, int width, std::ptrdiff_t stride) {
  return {height, width, CV_8UC1, const_cast<void*>(bytes), static_cast<std::size_t>(stride)};
}

/// On OpenCV's default device of the process. Kernels are compiled at construction, or come from OpenCV's cache; device
/// memory is 5 bytes a pixel and disparity, and some. One object, one caller at a time.
class OpenClMatcher : public DeviceMatcher {
 public:
  explicit OpenClMatcher(const MatcherSize& size) : program_(compile(size)), steps_(opencl::stepsFor(size)) {
    for (int i = 0; i < opencl::kBuffers; ++i) {
      const auto [height, width] = opencl::extentOf(opencl::Buffer(i), size);
      buffers_[i].create(height, width, CV_8UC1);
      if (buffers_[i].u->handle != nullptr) continue;
      throw DeviceError("OpenCL: the device cannot allocate " + std::to_string(buffers_[i].total()) + " bytes");
    }
    for (const opencl::Step& step : steps_) kernels_.emplace_back(step.kernel, program_);
  }

  std::string name() const override {
    return onDevice([] {
      const cv::ocl::Device& device = cv::ocl::Device::getDefault();
      return std::string(device.name() + " (" + device.version() + ")");
    });
  }

  void match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) override {
    onDevice([&] {
      ++pairs_;
      upload(rows(left.pixels, left.height, left.width, left.stride), opencl::kLeft);
      upload(rows(right.pixels, right.height, right.width, right.stride), opencl::kRight);
      upload(rows(&pairs_, 1, sizeof pairs_, sizeof pairs_), opencl::kPairNumber);
      for (std::size_t step = 0; step < steps_.size(); ++step) run(step);
      std::uint32_t done = 0;
      for (const auto& [buffer, to] : opencl::resultsTo(out, done)) {
        const cv::UMat& from = buffers_[buffer];
        from.copyTo(rows(to, from.rows, from.cols, from.cols));
      }
      if (done != pairs_)
        throw DeviceError("OpenCL: the device has not matched this pair");  // OpenCV drops some errors
    });
  }

 private:
  void upload(const cv::Mat& from, opencl::Buffer to) {
    if (from.size() != buffers_[to].size()) throw DeviceError("OpenCL: the matcher was made for another image size");
    from.copyTo(buffers_[to]);
  }

  void run(std::size_t step) {
    std::array<std::size_t, 3> work_items = steps_[step].work_items, group = steps_[step].group;
    int index = 0;
    for (const opencl::Buffer buffer : steps_[step].arguments) {
      index = kernels_[step].set(index, cv::ocl::KernelArg::PtrReadWrite(buffers_[buffer]));
    }
    if (index >= 0 && kernels_[step].run(3, work_items.data(), group.data(), true)) return;
    throw DeviceError(std::string("OpenCL: kernel ") + steps_[step].kernel + " does not run");
  }

  cv::ocl::Program program_;
  std::vector<opencl::Step> steps_;
  std::vector<cv::ocl::Kernel> kernels_;  // a step
  std::array<cv::UMat, opencl::kBuffers> buffers_;
  std::uint32_t pairs_ = 0;
};

}  // namespace

std::unique_ptr<DeviceMatcher> makeOpenClMatcher(const MatcherSize& size) {
  return onDevice([&]() -> std::unique_ptr<DeviceMatcher> {
    const bool exists = cv::ocl::haveOpenCL() && cv::ocl::useOpenCL() && cv::ocl::Device::getDefault().available();
    return exists ? std::make_unique<OpenClMatcher>(size) : nullptr;
  });
}

}  // namespace flight_corridor
