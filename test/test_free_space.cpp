#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "flight_corridor/map/free_space.hpp"
#include "support/calibrations.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallGeometry;

/// Cells of the free cubes, and where the nearest begins and the farthest ends along z of C.
struct Extent {
  double cells = 0.0, nearest_m = kInfinity, farthest_m = 0.0;
};

Extent findBefore(const cv::Mat& depth_m, double nearest_m = 0.0) {
  const MapConfig config;
  FreeSpace free_space(config, kSmallGeometry, nearest_m);
  Extent found;
  std::map<std::array<int, 4>, int> siblings;  // by their parent
  for (const FreeSpace::Cube& cube : free_space.find(depth_m, Eigen::Isometry3d::Identity())) {
    const int edge_cells = 1 << (EvidenceTree::kDepth - cube.depth), first_z = cube.key[2] - EvidenceTree::kKeyOrigin;
    found.nearest_m = std::min(found.nearest_m, first_z * config.resolution_m);
    found.farthest_m = std::max(found.farthest_m, (first_z + edge_cells) * config.resolution_m);
    found.cells += std::pow(edge_cells, 3);
    const auto parent = [&](int axis) { return cube.key[axis] / (2 * edge_cells); };
    const std::array<int, 4> family{parent(0), parent(1), parent(2), edge_cells};
    EXPECT_LT(++siblings[family], 8) << "eight are one";
  }
  return found;
}

TEST(FreeSpace, ReachesUpToTheBandBeforeAWall) {
  const Extent found = findBefore(test_support::wallDepth(kSmallGeometry.size(), 4.0));
  const double end_m = kSmallGeometry.shiftedDepth(4.0, MapConfig().free_band_px);
  EXPECT_LE(found.farthest_m, end_m + 1e-6);
  EXPECT_GT(found.farthest_m, end_m - MapConfig().resolution_m - 1e-6);
}

TEST(FreeSpace, BeginsWhereASurfaceWouldHaveBeenSeen) {
  const cv::Mat wall_m = test_support::wallDepth(kSmallGeometry.size(), 4.0);
  const Extent all = findBefore(wall_m);
  for (const double nearest_m : {0.33, 1.0, 1.47, 3.05}) {
    const Extent found = findBefore(wall_m, nearest_m);
    EXPECT_GE(found.nearest_m, nearest_m - 1e-6);
    EXPECT_LT(found.nearest_m, nearest_m + MapConfig().resolution_m + 1e-6);
    EXPECT_EQ(found.farthest_m, all.farthest_m);
    EXPECT_LT(found.cells, all.cells);
  }
}

TEST(FreeSpace, IsMostOfTheViewBeforeAWall) {
  const Extent found = findBefore(test_support::wallDepth(kSmallGeometry.size(), 4.0));
  const StereoCalibration& camera = kSmallGeometry.calibration();
  const double view_m3 = camera.size_px.area() / (camera.fx_px * camera.fy_px) * std::pow(found.farthest_m, 3) / 3.0;
  const double free_m3 = found.cells * std::pow(MapConfig().resolution_m, 3);
  EXPECT_LT(free_m3, view_m3);
  EXPECT_GT(free_m3, 0.75 * view_m3);  // cells on the border of the view are left out
}

TEST(FreeSpace, FindsNothingOfTheImageBefore) {
  FreeSpace free_space(MapConfig(), kSmallGeometry, 0.0);
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  EXPECT_GT(free_space.find(test_support::wallDepth(kSmallGeometry.size(), 4.0), here).size(), 0u);
  EXPECT_EQ(free_space.find(test_support::wallDepth(kSmallGeometry.size(), kNaN), here).size(), 0u);
}

TEST(FreeSpace, IsNoneWithoutRays) {
  EXPECT_EQ(findBefore(test_support::wallDepth(kSmallGeometry.size(), kNaN)).cells, 0.0);
}

}  // namespace
}  // namespace flight_corridor
