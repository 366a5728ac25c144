#include "ros/memory.hpp"

#include <malloc.h>

#include <limits>

namespace flight_corridor_ros {

namespace {

constexpr int kLargestOnHeap = 32 << 20;  // bytes: the most that glibc allows

}  // namespace

void keepFreedMemory() {
  if (mallopt(M_MMAP_THRESHOLD, kLargestOnHeap)) mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
}

}  // namespace flight_corridor_ros
