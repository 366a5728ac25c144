#pragma once

namespace flight_corridor_ros {

/// Makes the process keep the memory that it frees. For each pair OpenCV allocates and frees tens of MB; by default the
/// C library returns them in between, and the kernel zeroes every page again: a quarter of a pair's processor time. The
/// peak grows by some 5 %. For a program's main: it sets the whole process.
void keepFreedMemory();

}  // namespace flight_corridor_ros
