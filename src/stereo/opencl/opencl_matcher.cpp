#include "stereo/opencl/opencl_matcher.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/core/ocl.hpp>
#include <stdexcept>
#include <vector>

#include "flight_corridor/stereo/disparity_estimator.hpp"
#include "stereo/opencl/kernel_source.hpp"
#include "stereo/opencl/kernels.hpp"

namespace flight_corridor {

namespace {

constexpr char kNoDevice[] = "OpenCL finds no GPU: install its driver with OpenCL (clinfo lists it)";

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
  if (!OpenClMatcher::hasDevice()) throw DeviceError(kNoDevice);
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

}  // namespace

struct OpenClMatcher::Device {
  explicit Device(const MatcherSize& size) : program(compile(size)), steps(opencl::stepsFor(size)) {
    for (int i = 0; i < opencl::kBuffers; ++i) {
      const auto [height, width] = opencl::extentOf(opencl::Buffer(i), size);
      buffers[i].create(height, width, CV_8UC1);
      if (buffers[i].u->handle != nullptr) continue;
      throw DeviceError("OpenCL: the device cannot allocate " + std::to_string(buffers[i].total()) + " bytes");
    }
    for (const opencl::Step& step : steps) kernels.emplace_back(step.kernel, program);
  }

  void upload(const cv::Mat& from, opencl::Buffer to) {
    if (from.size() != buffers[to].size()) throw DeviceError("OpenCL: the matcher was made for another image size");
    from.copyTo(buffers[to]);
  }

  void run(std::size_t step) {
    std::array<std::size_t, 3> work_items = steps[step].work_items, group = steps[step].group;
    int index = 0;
    for (const opencl::Buffer buffer : steps[step].arguments) {
      index = kernels[step].set(index, cv::ocl::KernelArg::PtrReadWrite(buffers[buffer]));
    }
    if (index >= 0 && kernels[step].run(3, work_items.data(), group.data(), true)) return;
    throw DeviceError(std::string("OpenCL: kernel ") + steps[step].kernel + " does not run");
  }

  cv::ocl::Program program;
  std::vector<opencl::Step> steps;
  std::vector<cv::ocl::Kernel> kernels;  // a step
  std::array<cv::UMat, opencl::kBuffers> buffers;
};

OpenClMatcher::OpenClMatcher(const MatcherSize& size) {
  onDevice([&] { device_ = std::make_unique<Device>(size); });
}

OpenClMatcher::~OpenClMatcher() = default;

bool OpenClMatcher::hasDevice() {
  return onDevice(
      [] { return cv::ocl::haveOpenCL() && cv::ocl::useOpenCL() && cv::ocl::Device::getDefault().available(); });
}

std::string OpenClMatcher::name() const {
  return onDevice([] {
    const cv::ocl::Device& device = cv::ocl::Device::getDefault();
    return std::string(device.name() + " (" + device.version() + ")");
  });
}

void OpenClMatcher::match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) {
  onDevice([&] {
    ++pairs_;
    device_->upload(rows(left.pixels, left.height, left.width, left.stride), opencl::kLeft);
    device_->upload(rows(right.pixels, right.height, right.width, right.stride), opencl::kRight);
    device_->upload(rows(&pairs_, 1, sizeof pairs_, sizeof pairs_), opencl::kPairNumber);
    for (std::size_t step = 0; step < device_->steps.size(); ++step) device_->run(step);
    std::uint32_t done = 0;
    for (const auto& [buffer, to] : opencl::resultsTo(out, done)) {
      const cv::UMat& from = device_->buffers[buffer];
      from.copyTo(rows(to, from.rows, from.cols, from.cols));
    }
    if (done != pairs_) throw DeviceError("OpenCL: the device has not matched this pair");  // OpenCV drops some errors
  });
}

std::unique_ptr<DeviceMatcher> makeOpenClMatcher(const MatcherSize& size) {
  return OpenClMatcher::hasDevice() ? std::make_unique<OpenClMatcher>(size) : nullptr;
}

void requireDevice(const StereoConfig& config) {
  if (config.device != "gpu") return;
  constexpr MatcherSize kSize{64, 32, 0, 32};
  constexpr int kPixels = kSize.width_px * kSize.height_px, kShift_px = 5;
  std::vector<std::uint8_t> grey(kPixels + kShift_px);
  for (int i = 0; i < kPixels + kShift_px; ++i) grey[i] = static_cast<std::uint8_t>(i * i % 251);
  const GreyImage left{grey.data(), kSize.width_px, kSize.height_px, kSize.width_px};
  const GreyImage right{grey.data() + kShift_px, kSize.width_px, kSize.height_px, kSize.width_px};
  const auto set_by = [&](auto&& matcher) {
    std::vector<float> best(kPixels), repeated(kPixels);
    std::vector<std::uint8_t> farthest(kPixels), nearest(kPixels), flags(kPixels);
    std::vector<std::uint64_t> set(kPixels);
    matcher.match(left, right,
                  {best.data(), repeated.data(), farthest.data(), nearest.data(), flags.data(), set.data()});
    return set;
  };
  try {
    BandWorkers workers(1);
    if (set_by(OpenClMatcher(kSize)) == set_by(SemiGlobalMatcher(kSize, workers))) return;
    throw DeviceError("OpenCL: the device finds other matches than the CPU");
  } catch (const DeviceError& error) {
    throw std::invalid_argument("stereo/device: gpu: " + std::string(error.what()) + ", or choose cpu or auto");
  }
}

}  // namespace flight_corridor
