// The matcher on a GPU: equality with the slow matcher of the tests on 20 pairs, then times of upload, each kernel,
// download, and from images in host memory to evidence in host memory; where it is linked with the package
// (FLIGHT_CORRIDOR_CPU), beside the CPU's. Needs an OpenCL loader only; scripts/gpu_check compiles it.
//   gpu_matcher [--any] [KERNELS.cl]      --any: also another device than a GPU, and small images only

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <thread>
#include <vector>

#include "opencl.hpp"
#include "opencl/kernels.hpp"
#include "support/matcher_cases.hpp"

namespace {

using namespace flight_corridor;
using bench::check;
using bench::OpenCl;
using matcher_cases::Answers;
using matcher_cases::Pair;

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// The kernels for images of one size, on a device.
class GpuMatcher {
 public:
  using Times_ms = std::map<std::string, double>;

  GpuMatcher(const OpenCl& cl, OpenCl::Handle device, const std::string& source, const MatcherSize& size)
      : cl_(cl), size_(size), steps_(opencl::stepsFor(size)) {
    int status = 0;
    context_ = cl.call<Handle(const void*, unsigned, Handle*, void*, void*, int*)>("clCreateContext")(
        nullptr, 1, &device, nullptr, nullptr, &status);
    check(status, "context");
    queue_ = cl.call<Handle(Handle, Handle, std::uint64_t, int*)>("clCreateCommandQueue")(context_, device,
                                                                                          OpenCl::kProfiling, &status);
    check(status, "queue");
    const char* text = source.c_str();
    program_ = cl.call<Handle(Handle, unsigned, const char**, const std::size_t*, int*)>("clCreateProgramWithSource")(
        context_, 1, &text, nullptr, &status);
    build(device);
    for (int i = 0; i < opencl::kBuffers; ++i) {
      buffers_[i] = cl.call<Handle(Handle, std::uint64_t, std::size_t, void*, int*)>("clCreateBuffer")(
          context_, OpenCl::kReadWrite, bytes(opencl::Buffer(i)), nullptr, &status);
      check(status, "memory");
    }
    for (const opencl::Step& step : steps_) {
      kernels_.push_back(cl.call<Handle(Handle, const char*, int*)>("clCreateKernel")(program_, step.kernel, &status));
      check(status, step.kernel);
      for (unsigned i = 0; i < step.arguments.size(); ++i) {
        check(cl.call<int(Handle, unsigned, std::size_t, const void*)>("clSetKernelArg")(
                  kernels_.back(), i, sizeof(Handle), &buffers_[step.arguments[i]]),
              "argument");
      }
    }
  }

  ~GpuMatcher() {
    for (const Handle kernel : kernels_) release("clReleaseKernel", kernel);
    for (const Handle buffer : buffers_) release("clReleaseMemObject", buffer);
    release("clReleaseProgram", program_);
    release("clReleaseCommandQueue", queue_);
    release("clReleaseContext", context_);
  }
  GpuMatcher(const GpuMatcher&) = delete;
  GpuMatcher& operator=(const GpuMatcher&) = delete;

  /// @param rows of the images, without gaps.  @return what each part took.
  Times_ms match(const std::vector<std::uint8_t>& left, const std::vector<std::uint8_t>& right,
                 const MatchPlanes& out) {
    using Transfer = int(Handle, Handle, unsigned, std::size_t, std::size_t, void*, unsigned, Handle*, Handle*);
    auto* const write = cl_.call<Transfer>("clEnqueueWriteBuffer");
    auto* const read = cl_.call<Transfer>("clEnqueueReadBuffer");
    std::vector<std::pair<std::string, Handle>> events;
    const auto record = [&](const char* what) { return &events.emplace_back(what, nullptr).second; };
    const auto upload = [&](const void* from, opencl::Buffer to) {
      check(write(queue_, buffers_[to], 0, 0, bytes(to), const_cast<void*>(from), 0, nullptr, record("upload")),
            "upload");
    };
    const double start_ms = now_ms();
    ++pairs_;
    upload(left.data(), opencl::kLeft);
    upload(right.data(), opencl::kRight);
    upload(&pairs_, opencl::kPairNumber);
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      using Enqueue = int(Handle, Handle, unsigned, const std::size_t*, const std::size_t*, const std::size_t*,
                          unsigned, Handle*, Handle*);
      const opencl::Step& step = steps_[i];
      check(cl_.call<Enqueue>("clEnqueueNDRangeKernel")(queue_, kernels_[i], 3, nullptr, step.work_items.data(),
                                                        step.group.data(), 0, nullptr, record(step.kernel)),
            step.kernel);
    }
    std::uint32_t done = 0;
    for (const auto& [from, to] : opencl::resultsTo(out, done)) {
      check(read(queue_, buffers_[from], 0, 0, bytes(from), to, 0, nullptr, record("download")), "download");
    }
    check(cl_.call<int(Handle)>("clFinish")(queue_), "finish");
    if (done != pairs_) throw std::runtime_error("the device has not matched the pair");
    Times_ms times;
    times["whole"] = now_ms() - start_ms;
    for (const auto& [what, event] : events) {
      const double took_ms = duration_ms(event);
      times[what] += took_ms;
      if (what != "upload" && what != "download") times["kernels"] += took_ms;
      release("clReleaseEvent", event);
    }
    return times;
  }

 private:
  using Handle = OpenCl::Handle;

  std::size_t bytes(opencl::Buffer buffer) const {
    const auto [rows, bytes_per_row] = opencl::extentOf(buffer, size_);
    return static_cast<std::size_t>(rows) * bytes_per_row;
  }

  void build(Handle device) const {
    using Build = int(Handle, unsigned, Handle*, const char*, void*, void*);
    if (cl_.call<Build>("clBuildProgram")(program_, 1, &device, opencl::kernelOptions(size_).c_str(), nullptr,
                                          nullptr) == 0) {
      return;
    }
    std::string log(10000, '\0');
    cl_.call<int(Handle, Handle, unsigned, std::size_t, void*, std::size_t*)>("clGetProgramBuildInfo")(
        program_, device, OpenCl::kBuildLog, log.size() - 1, log.data(), nullptr);
    throw std::runtime_error("the kernels cannot be compiled: " + std::string(log.c_str()));
  }

  double duration_ms(Handle event) const {
    const auto at = [&](unsigned what) {
      std::uint64_t at_ns = 0;
      check(cl_.call<int(Handle, unsigned, std::size_t, void*, std::size_t*)>("clGetEventProfilingInfo")(
                event, what, sizeof at_ns, &at_ns, nullptr),
            "profile");
      return at_ns;
    };
    return static_cast<double>(at(OpenCl::kCommandEnd) - at(OpenCl::kCommandStart)) / 1e6;
  }

  void release(const char* function, Handle handle) const { cl_.call<int(Handle)>(function)(handle); }

  const OpenCl& cl_;
  std::uint32_t pairs_ = 0;
  MatcherSize size_;
  std::vector<opencl::Step> steps_;
  Handle context_ = nullptr, queue_ = nullptr, program_ = nullptr;
  std::array<Handle, opencl::kBuffers> buffers_{};
  std::vector<Handle> kernels_;  // a step
};

/// An image's rows without the gaps between them.
std::vector<std::uint8_t> packed(const GreyImage& image) {
  std::vector<std::uint8_t> pixels;
  for (int v = 0; v < image.height; ++v) pixels.insert(pixels.end(), image.row(v), image.row(v) + image.width);
  return pixels;
}

using Make = std::function<std::unique_ptr<GpuMatcher>(const MatcherSize&)>;

/// @return whether all are equal.
bool compare(const Make& make) {
  int equal = 0, pairs = 0;
  for (const MatcherSize& size : matcher_cases::sizes()) {
    const auto matcher = make(size);
    for (const auto scene : {matcher_cases::Scene::Surfaces, matcher_cases::Scene::Stripes}) {
      const Pair pair = matcher_cases::makePair(scene, size, 5);
      Answers answers(size);
      matcher->match(packed(pair.leftView()), packed(pair.rightView()), answers.planes());
      const std::string difference = firstDifference(answers, matchedSlowly(pair, size));
      if (!difference.empty()) std::printf("%s%s\n", describe(scene, size).c_str(), difference.c_str());
      equal += difference.empty();
      ++pairs;
    }
  }
  std::printf("%d of %d pairs are equal, bit by bit, to the slow matcher's\n", equal, pairs);
  return equal == pairs;
}

/// Median of the CPU's matcher; NaN where it is not linked.
double cpu_ms([[maybe_unused]] const Pair& pair, [[maybe_unused]] const MatcherSize& size,
              [[maybe_unused]] int repeats) {
#ifdef FLIGHT_CORRIDOR_CPU
  BandWorkers workers(static_cast<int>(std::thread::hardware_concurrency()));
  SemiGlobalMatcher matcher(size, workers);
  Answers answers(size);
  std::vector<double> took_ms;
  for (int i = -1; i < repeats; ++i) {
    const double start_ms = now_ms();
    matcher.match(pair.leftView(), pair.rightView(), answers.planes());
    if (i >= 0) took_ms.push_back(now_ms() - start_ms);
  }
  return median(took_ms);
#else
  return std::numeric_limits<double>::quiet_NaN();
#endif
}

void printTimes(const Make& make, bool is_gpu) {
  const std::vector<const char*> columns{"upload", "census",  "aggregate", "findMinima", "judge",
                                         "fit",    "average", "download",  "kernels",    "whole"};
  const int repeats = is_gpu ? 30 : 3;
  std::printf("\nmedian of %d [ms]; whole: from images to evidence, both in host memory; cpu: %u threads\n\n", repeats,
              std::thread::hardware_concurrency());
  std::printf("| image | disparities |");
  for (const char* column : columns) std::printf(" %s |", column);
  std::printf(" cpu |\n|---|---|");
  for (std::size_t i = 0; i <= columns.size(); ++i) std::printf("---|");
  for (const auto& [width, height] : {std::pair{320, 240}, {640, 480}, {1280, 720}, {1280, 960}}) {
    for (const int disparities : {64, 128, 256}) {
      if (!is_gpu && (width > 320 || disparities > 128)) continue;
      const MatcherSize size{width, height, 0, disparities};
      const Pair pair = matcher_cases::makePair(matcher_cases::Scene::Surfaces, size, 1);
      const auto left = packed(pair.leftView()), right = packed(pair.rightView());
      const auto matcher = make(size);
      Answers answers(size);
      std::map<std::string, std::vector<double>> took_ms;
      for (int i = -1; i < repeats; ++i) {
        for (const auto& [what, part_ms] : matcher->match(left, right, answers.planes())) {
          if (i >= 0) took_ms[what].push_back(part_ms);
        }
      }
      std::printf("\n| %d x %d | %d |", width, height, disparities);
      for (const char* column : columns) std::printf(" %.3f |", median(took_ms[column]));
      const double on_cpu_ms = cpu_ms(pair, size, repeats);
      std::printf(std::isnan(on_cpu_ms) ? " – |" : " %.1f |", on_cpu_ms);
      std::fflush(stdout);
    }
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) try {
  const bool any = argc > 1 && std::strcmp(argv[1], "--any") == 0;
  const char* const path = argc > 1 + any ? argv[1 + any] : FLIGHT_CORRIDOR_KERNELS;
  std::ifstream file(path);
  const std::string source{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (source.empty()) throw std::runtime_error(std::string(path) + " cannot be read");
  const OpenCl cl;
  const OpenCl::Handle device = cl.device(any);
  std::printf("%s, %s\n", cl.text(device, OpenCl::kDeviceName).c_str(),
              cl.text(device, OpenCl::kDeviceVersion).c_str());
  const Make make = [&](const MatcherSize& size) { return std::make_unique<GpuMatcher>(cl, device, source, size); };
  if (!compare(make)) return 1;
  printTimes(make, cl.isGpu(device));
  return 0;
} catch (const std::exception& error) {
  std::cerr << "gpu_matcher: " << error.what() << '\n';
  return 2;
}
