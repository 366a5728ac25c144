#pragma once

namespace flight_corridor::opencl {

/// Text of semi_global_matcher.cl.
extern const char* const kKernelSource;

}  // namespace flight_corridor::opencl
