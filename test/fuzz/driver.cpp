#include <cstdint>
#include <opencv2/core/utility.hpp>

#include "silence.hpp"

// Before the first input of any driver. One thread: a finding is found again.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  cv::setNumThreads(1);
  flight_corridor::fuzz::silenceRos();
  return 0;
}
