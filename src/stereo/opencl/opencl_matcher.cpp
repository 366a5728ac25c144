#include "stereo/opencl/opencl_matcher.hpp"

#include <initializer_list>
#include <opencv2/core.hpp>
#include <opencv2/core/ocl.hpp>

#include "flight_corridor/stereo/matching_rules.hpp"
#include "stereo/opencl/kernel_options.hpp"
#include "stereo/opencl/kernel_source.hpp"

namespace flight_corridor {

namespace {

cv::ocl::Kernel makeKernel(const char* name, const cv::ocl::Program& program) {
  cv::ocl::Kernel kernel(name, program);
  if (kernel.empty()) throw DeviceError(std::string("OpenCL: no kernel ") + name);
  return kernel;
}

cv::ocl::Program compile(const MatcherSize& size) {
  if (!cv::ocl::haveOpenCL() || !cv::ocl::Device::getDefault().available()) {
    throw DeviceError("OpenCL finds no device: install the GPU's driver with its OpenCL part, see clinfo");
  }
  const cv::ocl::ProgramSource source("flight_corridor", "semi_global_matcher", opencl::kKernelSource, "");
  cv::String errors;
  const cv::ocl::Program program =
      cv::ocl::Context::getDefault().getProg(source, opencl::kernelOptions(size), errors);
  if (program.ptr() == nullptr) throw DeviceError("OpenCL: the kernels cannot be compiled: " + errors.substr(0, 500));
  return program;
}

size_t roundedUp(int count, int step) { return static_cast<size_t>((count + step - 1) / step) * step; }

void run(cv::ocl::Kernel& kernel, std::initializer_list<size_t> global, std::initializer_list<size_t> local,
         const std::vector<cv::UMat*>& buffers) {
  int index = 0;
  for (const cv::UMat* buffer : buffers) index = kernel.set(index, cv::ocl::KernelArg::PtrReadWrite(*buffer));
  size_t global_size[3], local_size[3];
  std::copy(global.begin(), global.end(), global_size);
  std::copy(local.begin(), local.end(), local_size);
  if (!kernel.run(static_cast<int>(global.size()), global_size, local_size, true)) {
    throw DeviceError("OpenCL: a kernel does not run");
  }
}

/// OpenCV's errors as DeviceError.
template <class Job>
void onDevice(Job&& job) {
  try {
    job();
  } catch (const cv::Exception& error) {
    throw DeviceError("OpenCL: " + error.err);
  }
}

}  // namespace

struct OpenClMatcher::Device {
  explicit Device(const MatcherSize& size)
      : program(compile(size)),
        census(makeKernel("census", program)),
        aggregate(makeKernel("aggregate", program)),
        find_minima(makeKernel("findMinima", program)),
        judge(makeKernel("judge", program)),
        fit(makeKernel("fit", program)),
        average(makeKernel("average", program)) {
    const int rows = size.height_px, columns = size.width_px;
    const auto allocate = [rows](cv::UMat& buffer, int buffer_columns, int type) {
      buffer.create(rows, buffer_columns, type);
      if (buffer.u->handle == nullptr) throw DeviceError("OpenCL: the device has not enough memory");
    };
    for (cv::UMat* image : {&left, &right}) allocate(*image, columns, CV_8UC1);
    for (cv::UMat* codes : {&left_codes, &right_codes}) allocate(*codes, columns, CV_16UC1);
    for (cv::UMat& path : paths) allocate(path, columns * size.num_disparities, CV_8UC1);
    for (cv::UMat* plane : {&winner, &rise_below, &rise_above, &flags, &farthest, &nearest})
      allocate(*plane, columns, CV_8UC1);
    allocate(set, columns, CV_8UC(storedDisparities(size.num_disparities) / 8));
    allocate(fixed, columns, CV_16SC1);
    for (cv::UMat* plane : {&best, &repeated}) allocate(*plane, columns, CV_32FC1);
  }

  cv::ocl::Program program;
  cv::ocl::Kernel census, aggregate, find_minima, judge, fit, average;
  cv::UMat left, right, left_codes, right_codes, paths[5];
  cv::UMat winner, rise_below, rise_above, flags, farthest, nearest, set, fixed, best, repeated;
};

OpenClMatcher::OpenClMatcher(const MatcherSize& size) : size_(size) {
  onDevice([&] { device_ = std::make_unique<Device>(size); });
}

OpenClMatcher::~OpenClMatcher() = default;

bool OpenClMatcher::isHostProcessor() {
  return cv::ocl::haveOpenCL() && (cv::ocl::Device::getDefault().type() & cv::ocl::Device::TYPE_CPU) != 0;
}

std::string OpenClMatcher::name() const {
  const cv::ocl::Device& device = cv::ocl::Device::getDefault();
  return device.name() + " (" + device.version() + ")";
}

void OpenClMatcher::match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) {
  onDevice([&] {
    Device& d = *device_;
    const int width = size_.width_px, height = size_.height_px, bands = bandsOf(height);
    const auto upload = [](const GreyImage& image, cv::UMat& to) {
      cv::Mat(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels), image.stride).copyTo(to);
    };
    const std::initializer_list<size_t> tiles{roundedUp(width, 16), roundedUp(height, 4)};
    upload(left, d.left);
    run(d.census, tiles, {16, 4}, {&d.left, &d.left_codes});
    upload(right, d.right);
    run(d.census, tiles, {16, 4}, {&d.right, &d.right_codes});
    const int lines = width + (height + bands - 1) / bands + SemiGlobalMatcher::kRunUp_px;  // of an oblique path
    run(d.aggregate, {static_cast<size_t>(lines) * opencl::kLanes, static_cast<size_t>(bands), 5}, {opencl::kLanes, 1, 1},
        {&d.left, &d.left_codes, &d.right_codes, &d.paths[0], &d.paths[1], &d.paths[2], &d.paths[3], &d.paths[4]});
    run(d.find_minima, {static_cast<size_t>(height) * opencl::kGroup}, {opencl::kGroup},
        {&d.paths[0], &d.paths[1], &d.paths[2], &d.paths[3], &d.paths[4], &d.winner, &d.rise_below, &d.rise_above,
         &d.flags, &d.set});
    run(d.judge, {roundedUp(width, opencl::kTile_px) / opencl::kTile_px * opencl::kGroup, static_cast<size_t>(height)},
        {opencl::kGroup, 1},
        {&d.left_codes, &d.right_codes, &d.winner, &d.flags, &d.farthest, &d.nearest});
    run(d.fit, tiles, {16, 4}, {&d.left, &d.right, &d.winner, &d.rise_below, &d.rise_above, &d.flags, &d.fixed});
    run(d.average, tiles, {16, 4}, {&d.fixed, &d.flags, &d.best, &d.repeated});
    const auto download = [&](const cv::UMat& from, void* to) {
      from.copyTo(cv::Mat(height, width, from.type(), to));
    };
    download(d.set, out.set);
    download(d.flags, out.flags);
    download(d.farthest, out.competitor_farthest);
    download(d.nearest, out.competitor_nearest);
    download(d.best, out.best);
    download(d.repeated, out.repeated);
  });
}

}  // namespace flight_corridor
