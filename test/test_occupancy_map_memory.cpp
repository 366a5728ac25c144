#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "flight_corridor/map/occupancy_map.hpp"
#include "support/calibrations.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallGeometry;
using test_support::wallDepth;

/// Of this process.
double residentMemory_MB() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0.0;
  statm >> pages >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

TEST(OccupancyMap, InsertingLeavesNoMemoryBehindWhateverThreadsDo) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "it keeps what is freed";
#endif
  OccupancyMap map(MapConfig(), kSmallGeometry);
  const cv::Mat depth_m = wallDepth(kSmallGeometry.size(), 3.0);
  const auto insert = [&](int times) {
    for (int i = 0; i < times; ++i) map.insert(depth_m, Eigen::Isometry3d::Identity());
  };
  insert(200);
  const double before_MB = residentMemory_MB();
  insert(1500);
  EXPECT_LT(residentMemory_MB() - before_MB, 0.5);  // 350 bytes an insertion
}

}  // namespace
}  // namespace flight_corridor
