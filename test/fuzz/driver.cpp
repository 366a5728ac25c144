#include <rosbag/bag.h>

#include <cstdint>
#include <opencv2/core/utility.hpp>

#include "silence.hpp"

// Before the first input of any driver. One thread: a finding is found again.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  static const rosbag::Bag kept;  // its plugins stay loaded; each bag would load them anew
  cv::setNumThreads(1);
  flight_corridor::fuzz::silenceRos();
  return 0;
}
