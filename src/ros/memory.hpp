#pragma once

namespace flight_corridor_ros {

/// From now on the process keeps the memory that it frees. For each pair OpenCV takes and frees tens of MB; by default
/// the C library hands them back in between, and the kernel zeroes every page anew: a quarter of a pair's processor
/// time. The most that is ever held grows by some 5 %. For a program's main: it sets the whole process.
void keepFreedMemory();

}  // namespace flight_corridor_ros
