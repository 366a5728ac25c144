#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <vector>

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

FreeSpace::FreeCubes joined(const std::vector<FreeSpace::FreeCubes>& lists) {
  FreeSpace::FreeCubes all;
  for (const FreeSpace::FreeCubes& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

Extent findBefore(const cv::Mat& depth_m, double nearest_m = 0.0) {
  const MapConfig config;
  FreeSpace free_space(config, kSmallGeometry, nearest_m);
  Extent found;
  for (const FreeSpace::FreeChildren& cube : joined(free_space.find(depth_m, Eigen::Isometry3d::Identity()))) {
    EXPECT_TRUE(cube.children != 0xFFu || cube.depth == FreeSpace::kBlockDepth) << "cubes of a block are joined";
    for (unsigned i = 0; i < 8; ++i) {
      if ((cube.children >> i & 1u) == 0) continue;
      const int edge_cells = 1 << (EvidenceTree::kDepth - cube.depth - 1);
      const int first_z = EvidenceTree::childKey(cube.key, cube.depth, i)[2] - 32768;
      const int last_z = first_z + edge_cells;
      found.nearest_m = std::min(found.nearest_m, first_z * config.resolution_m);
      found.cells += std::pow(edge_cells, 3);
      found.farthest_m = std::max(found.farthest_m, last_z * config.resolution_m);
    }
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

TEST(FreeSpace, IsTheSameForAnyNumberOfThreads) {
  const cv::Mat depth_m = test_support::wallDepth(kSmallGeometry.size(), 4.0);
  const auto found_by = [&](int threads) {
    const int usual = cv::getNumThreads();
    cv::setNumThreads(threads);
    FreeSpace free_space(MapConfig(), kSmallGeometry, 0.0);
    const FreeSpace::FreeCubes cubes = joined(free_space.find(depth_m, Eigen::Isometry3d::Identity()));
    cv::setNumThreads(usual);
    return cubes;
  };
  const FreeSpace::FreeCubes by_one = found_by(1), by_four = found_by(4);
  ASSERT_GT(by_one.size(), 0u);
  ASSERT_EQ(by_one.size(), by_four.size());
  for (std::size_t i = 0; i < by_one.size(); ++i) {
    EXPECT_EQ(by_one[i].key, by_four[i].key);
    EXPECT_EQ(by_one[i].depth, by_four[i].depth);
    EXPECT_EQ(by_one[i].children, by_four[i].children);
  }
}

TEST(FreeSpace, FindsNothingOfTheImageBefore) {
  FreeSpace free_space(MapConfig(), kSmallGeometry, 0.0);
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  EXPECT_GT(joined(free_space.find(test_support::wallDepth(kSmallGeometry.size(), 4.0), here)).size(), 0u);
  EXPECT_EQ(joined(free_space.find(test_support::wallDepth(kSmallGeometry.size(), kNaN), here)).size(), 0u);
}

TEST(FreeSpace, IsNoneWithoutRays) {
  EXPECT_EQ(findBefore(test_support::wallDepth(kSmallGeometry.size(), kNaN)).cells, 0.0);
}

}  // namespace
}  // namespace flight_corridor
