#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <map>
#include <opencv2/core.hpp>

#include "flight_corridor/map/point_counter.hpp"
#include "support/calibrations.hpp"
#include "support/ray_oracle.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallGeometry;
using test_support::withoutHitBand;

std::uint32_t pointsAt(double depth_m, const Eigen::Isometry3d& T_M_C) {
  const cv::Mat wall_m = test_support::wallDepth(kSmallGeometry.size(), depth_m);
  std::uint32_t points = 0;
  for (const auto& [cell, count] : countPoints(wall_m, T_M_C, kSmallGeometry, withoutHitBand())) points += count;
  return points;
}

TEST(PointCounter, CountsEveryPointWithinTheRange) {
  const auto pixels = static_cast<std::uint32_t>(kSmallGeometry.size().area());
  EXPECT_EQ(pointsAt(4.05, Eigen::Isometry3d::Identity()), pixels);
  EXPECT_EQ(pointsAt(9.0, Eigen::Isometry3d::Identity()), 0u);
  EXPECT_EQ(pointsAt(kNaN, Eigen::Isometry3d::Identity()), 0u);
}

TEST(PointCounter, CountsNothingOutsideOfWhatAnOctreeHolds) {
  EXPECT_EQ(pointsAt(4.05, Eigen::Isometry3d(Eigen::Translation3d(4000, 0, 0))), 0u);
  const std::uint32_t some =
      pointsAt(4.05, Eigen::Isometry3d(Eigen::Translation3d(3276.8, 0, 0)));  // across its border
  EXPECT_GT(some, 0u);
  EXPECT_LT(some, static_cast<std::uint32_t>(kSmallGeometry.size().area()));
}

TEST(PointCounter, ACellHoldsThePixelsThatSeeIt) {
  const Eigen::Isometry3d T_M_C(Eigen::Translation3d(1.0, -2.0, 0.5));
  const cv::Mat wall_m = test_support::wallDepth(kSmallGeometry.size(), 4.05);
  std::map<std::array<int, 3>, std::uint32_t> expected, found;
  for (int v = 0; v < kSmallGeometry.size().height; ++v) {
    for (int u = 0; u < kSmallGeometry.size().width; ++u) {
      const Eigen::Array3d cell = (T_M_C * kSmallGeometry.point(u, v, 4.05)).array() / withoutHitBand().resolution_m;
      const Eigen::Array3i key = cell.floor().cast<int>() + 32768;
      ++expected[{key[0], key[1], key[2]}];
    }
  }
  for (const auto& [key, count] : countPoints(wall_m, T_M_C, kSmallGeometry, withoutHitBand())) {
    found[{key[0], key[1], key[2]}] = count;
  }
  int moved = 0;  // points on a border between cells, by rounding
  for (const auto& [cell, count] : expected) moved += std::abs(static_cast<int>(count) - static_cast<int>(found[cell]));
  EXPECT_LE(moved, 0.001 * kSmallGeometry.size().area());
}

}  // namespace
}  // namespace flight_corridor
