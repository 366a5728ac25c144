#pragma once

#include <dlfcn.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

/// As much of OpenCL 1.2 as gpu_matcher needs, from whatever loader the machine has: no headers, nothing to link.
namespace flight_corridor::bench {

class OpenCl {
 public:
  using Handle = struct Opaque*;

  static constexpr std::uint64_t kGpu = 1 << 2, kAnyDevice = 0xFFFFFFFF, kProfiling = 1 << 1, kReadWrite = 1 << 0;
  static constexpr unsigned kDeviceType = 0x1000, kDeviceName = 0x102B, kDeviceVersion = 0x102F, kBuildLog = 0x1183;
  static constexpr unsigned kCommandStart = 0x1282, kCommandEnd = 0x1283;

  /// @throws std::runtime_error when there is no loader.
  OpenCl() {
    for (const char* name : {"libOpenCL.so.1", "libOpenCL.so"}) {
      if (library_ == nullptr) library_ = dlopen(name, RTLD_NOW);
    }
    if (library_ == nullptr) throw std::runtime_error("no OpenCL loader (libOpenCL.so.1)");
  }

  /// The first GPU; without one, where any will do, another device.
  Handle device(bool any) const {
    Handle platforms[16] = {}, device = nullptr;
    unsigned count = 0;
    call<int(unsigned, Handle*, unsigned*)>("clGetPlatformIDs")(16, platforms, &count);
    for (const std::uint64_t type : {kGpu, kAnyDevice}) {
      for (unsigned i = 0; i < std::min(count, 16u) && device == nullptr && (type == kGpu || any); ++i) {
        call<int(Handle, std::uint64_t, unsigned, Handle*, unsigned*)>("clGetDeviceIDs")(platforms[i], type, 1, &device,
                                                                                         nullptr);
      }
    }
    if (device == nullptr) throw std::runtime_error("OpenCL finds no GPU; --any takes another device");
    return device;
  }

  std::string text(Handle device, unsigned what) const {
    char text[256] = {};
    call<int(Handle, unsigned, std::size_t, void*, std::size_t*)>("clGetDeviceInfo")(device, what, sizeof text - 1,
                                                                                     text, nullptr);
    return text;
  }

  bool isGpu(Handle device) const {
    std::uint64_t type = 0;
    call<int(Handle, unsigned, std::size_t, void*, std::size_t*)>("clGetDeviceInfo")(device, kDeviceType, sizeof type,
                                                                                     &type, nullptr);
    return (type & kGpu) != 0;
  }

  /// A function of the loader.
  template <class Function>
  Function* call(const char* name) const {
    void* const found = dlsym(library_, name);
    if (found == nullptr) throw std::runtime_error(std::string("the OpenCL loader has no ") + name);
    return reinterpret_cast<Function*>(found);
  }

 private:
  void* library_ = nullptr;
};

inline void check(int status, const char* what) {
  if (status != 0) throw std::runtime_error(std::string("OpenCL: ") + what + ": error " + std::to_string(status));
}

}  // namespace flight_corridor::bench
