#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "flight_corridor/map/occupancy_map.hpp"
#include "support/calibrations.hpp"
#include "support/ray_oracle.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using test_support::Cell;
using test_support::kSmallGeometry;
using test_support::wallDepth;
using test_support::withoutHitBand;

Cell cellAt(const OccupancyMap& map, const Eigen::Vector3d& p_M) {
  const octomap::OcTreeNode* node = map.tree().search(p_M.x(), p_M.y(), p_M.z());
  if (!node) return Cell::Unknown;
  return map.tree().isNodeOccupied(node) ? Cell::Occupied : Cell::Free;
}

TEST(OccupancyMap, SurfacesAreTakenToBeNearerByTheHitBand) {
  OccupancyMap map(MapConfig(), kSmallGeometry);
  const double depth_m = 4.02;
  ASSERT_LT(kSmallGeometry.shiftedDepth(depth_m, MapConfig().hit_band_px), 4.0);
  map.insert(wallDepth(kSmallGeometry.size(), depth_m), Eigen::Isometry3d::Identity());
  EXPECT_EQ(cellAt(map, {0.0, 0.3, 3.95}), Cell::Occupied);
  EXPECT_EQ(cellAt(map, {0.0, 0.3, depth_m}), Cell::Unknown);
}

TEST(OccupancyMap, AWallIsOccupiedBeforeItFreeBehindItUnknown) {
  OccupancyMap map(withoutHitBand(), kSmallGeometry);
  map.insert(wallDepth(kSmallGeometry.size(), 4.05), Eigen::Isometry3d::Identity());
  for (const double x : {-2.0, 0.0, 1.5}) {
    EXPECT_EQ(cellAt(map, {x, 0.3, 4.05}), Cell::Occupied) << x;
    EXPECT_EQ(cellAt(map, {x, 0.3, 3.2}), Cell::Free) << x;
    EXPECT_EQ(cellAt(map, {x, 0.3, 4.4}), Cell::Unknown) << x;
  }
  EXPECT_EQ(cellAt(map, {4.0, 0.0, 2.0}), Cell::Unknown);   // outside the view
  EXPECT_EQ(cellAt(map, {0.0, 0.0, -1.0}), Cell::Unknown);  // behind the camera
}

TEST(OccupancyMap, WhatAnOctreeDoesNotHoldIsLeftOut) {
  OccupancyMap map(withoutHitBand(), kSmallGeometry);
  const cv::Mat wall_m = wallDepth(kSmallGeometry.size(), 4.05);
  map.insert(wall_m, Eigen::Isometry3d(Eigen::Translation3d(4000, 0, 0)));
  EXPECT_EQ(map.tree().size(), 0u);
  map.insert(wall_m, Eigen::Isometry3d(Eigen::Translation3d(3276.8, 0, 0)));  // across its border
  EXPECT_EQ(cellAt(map, {3276.75, 0.3, 4.05}), Cell::Occupied);
  EXPECT_EQ(cellAt(map, {-3276.75, 0.3, 4.05}), Cell::Unknown);
}

TEST(OccupancyMap, WhatDoesNotClearHitsAlone) {
  OccupancyMap map(withoutHitBand(), kSmallGeometry);
  map.insert(wallDepth(kSmallGeometry.size(), 4.05), Eigen::Isometry3d::Identity(), false);
  EXPECT_EQ(cellAt(map, {0.0, 0.3, 4.05}), Cell::Occupied);
  EXPECT_EQ(cellAt(map, {0.0, 0.3, 3.2}), Cell::Unknown);
}

TEST(OccupancyMap, PixelsWithoutDepthCastNoRay) {
  cv::Mat depth = wallDepth(kSmallGeometry.size(), 6.0);
  depth.colRange(160, 320).setTo(kNaN);
  OccupancyMap map(MapConfig(), kSmallGeometry);
  map.insert(depth, Eigen::Isometry3d::Identity());
  EXPECT_EQ(cellAt(map, {-1.0, 0.0, 3.0}), Cell::Free);
  EXPECT_EQ(cellAt(map, {1.0, 0.0, 3.0}), Cell::Unknown);
}

TEST(OccupancyMap, AThinPoleIsThereBesideFreeSpace) {
  cv::Mat depth = wallDepth(kSmallGeometry.size(), 6.0);
  depth(cv::Rect(159, 0, 3, 240)).setTo(3.05);  // 5 cm
  OccupancyMap map(withoutHitBand(), kSmallGeometry);
  map.insert(depth, Eigen::Isometry3d::Identity());
  EXPECT_EQ(cellAt(map, {0.02, 0.05, 3.05}), Cell::Occupied);
  EXPECT_EQ(cellAt(map, {1.05, 0.05, 3.05}), Cell::Free);
}

TEST(OccupancyMap, ASpeckleIsNoHitWhereAFaceWouldShowManyPoints) {
  cv::Mat depth = wallDepth(kSmallGeometry.size(), 6.0);
  depth(cv::Rect(160, 120, 8, 8)).setTo(0.45);  // a full face there shows 39 x 39 pixels
  OccupancyMap map(MapConfig(), kSmallGeometry);
  map.insert(depth, Eigen::Isometry3d::Identity());
  EXPECT_NE(cellAt(map, kSmallGeometry.point(164, 124, 0.45)), Cell::Occupied);
}

/// Tilted planes and balls at random places, seen along their pixels.
cv::Mat randomDepth(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  cv::Mat depth = wallDepth(kSmallGeometry.size(), 5.0 + unit(random));
  const Eigen::Vector3d slope(0.3 * unit(random), 0.3 * unit(random), 1.0);
  const Eigen::Vector3d ball(unit(random), 0.7 * unit(random), 2.5 + unit(random));
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const Eigen::Vector3d ray = kSmallGeometry.point(u, v, 1.0);
      double z = 5.0 / slope.dot(ray);
      const double b = ray.dot(ball), c = ball.squaredNorm() - 0.25, square = ray.squaredNorm();
      if (b * b > square * c) z = std::min(z, (b - std::sqrt(b * b - square * c)) / square);
      depth.at<float>(v, u) = static_cast<float>(z);
    }
  }
  return depth;
}

TEST(OccupancyMap, AVanishedObstacleIsFreedAndANewOneSeenAtOnce) {
  MapConfig config = withoutHitBand();
  config.frame_id = "odom";
  OccupancyMap map(config, kSmallGeometry);
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d place(0.05, 0.05, 3.05);
  for (int i = 0; i < 50; ++i) map.insert(wallDepth(kSmallGeometry.size(), 6.0), here);
  EXPECT_EQ(cellAt(map, place), Cell::Free);
  map.insert(wallDepth(kSmallGeometry.size(), 3.05), here);
  EXPECT_EQ(cellAt(map, place), Cell::Occupied);
  for (int i = 0; i < 50; ++i) map.insert(wallDepth(kSmallGeometry.size(), 3.05), here);
  int frames = 0;
  while (cellAt(map, place) == Cell::Occupied && frames < 100) {
    map.insert(wallDepth(kSmallGeometry.size(), 6.0), here);
    ++frames;
  }
  EXPECT_LE(frames, 15);  // half a second of 30 Hz
}

TEST(OccupancyMap, InnerNodesTellOfTheirChildren) {
  OccupancyMap map(MapConfig(), kSmallGeometry);
  std::mt19937 random(4);
  for (int i = 0; i < 3; ++i) map.insert(randomDepth(random), Eigen::Isometry3d(Eigen::Translation3d(0.1 * i, 0, 0)));
  octomap::OcTree rebuilt(map.tree());
  rebuilt.updateInnerOccupancy();
  rebuilt.prune();
  EXPECT_EQ(map.tree(), rebuilt);
  EXPECT_EQ(map.tree().size(), map.tree().calcNumNodes());
}

TEST(OccupancyMap, ABeamFreesItsWayAndHitsItsEnd) {
  OccupancyMap map(MapConfig(), kSmallGeometry);
  map.insertBeam({0.05, 0.05, 0.05}, {0.05, 0.05, 3.05});
  EXPECT_EQ(cellAt(map, {0.05, 0.05, 3.05}), Cell::Occupied);
  EXPECT_EQ(cellAt(map, {0.05, 0.05, 1.55}), Cell::Free);
  EXPECT_EQ(cellAt(map, {0.05, 0.05, 3.25}), Cell::Unknown);
  const std::size_t size = map.tree().size();
  for (const double far_m : {kNaN, kInfinity, -1e308, 1e308, 1e12, 4000.0}) {
    map.insertBeam({0, 0, 0}, {far_m, 0, 1});
    map.insertBeam({far_m, 0, 1}, {0, 0, 0});
  }
  EXPECT_EQ(map.tree().size(), size) << "what has no key does no harm";
}

MapConfig inFixedFrame() {
  MapConfig config = withoutHitBand();
  config.frame_id = "odom";
  return config;
}

TEST(OccupancyMap, TheWindowMovesWithTheCamera) {
  OccupancyMap map(inFixedFrame(), kSmallGeometry);
  map.keepAround({0, 0, 0}, 0.0);
  map.insert(wallDepth(kSmallGeometry.size(), 3.95), Eigen::Isometry3d::Identity());
  const Eigen::Vector3d wall(0.05, 0.3, 3.95);
  map.keepAround({0, 0, 11.0}, 1.0);
  EXPECT_EQ(cellAt(map, wall), Cell::Occupied) << "7 m behind";
  EXPECT_EQ(cellAt(map, {0.05, 0.05, 0.95}), Cell::Unknown) << "10 m behind";
  map.keepAround({0, 0, 30.0}, 1.0);
  EXPECT_EQ(map.tree().size(), 0u);
}

TEST(OccupancyMap, WhatIsNotSeenForLongIsForgotten) {
  OccupancyMap map(inFixedFrame(), kSmallGeometry);
  cv::Mat depth_m = wallDepth(kSmallGeometry.size(), 3.95);
  map.keepAround({0, 0, 0}, 0.0);
  map.insert(depth_m, Eigen::Isometry3d::Identity());
  depth_m.colRange(0, 160).setTo(kNaN);  // from now on the left half shows nothing
  const Eigen::Vector3d left(-1.65, 0.05, 3.95), right(1.65, 0.05, 3.95);
  for (double stamp_s = 0.0; stamp_s <= MapConfig().forget_s; stamp_s += 1.0) {
    map.keepAround({0, 0, 0}, stamp_s);
    map.insert(depth_m, Eigen::Isometry3d::Identity());
    EXPECT_EQ(cellAt(map, left), Cell::Occupied) << stamp_s;
  }
  map.keepAround({0, 0, 0}, MapConfig().forget_s + 1.0);
  EXPECT_EQ(cellAt(map, left), Cell::Unknown);
  EXPECT_EQ(cellAt(map, right), Cell::Occupied);
}

TEST(OccupancyMap, WhatIsSeenAfterClearingIsForgottenToo) {
  OccupancyMap map(inFixedFrame(), kSmallGeometry);
  map.keepAround({0, 0, 0}, 0.0);
  for (int i = 0; i < 2; ++i) {
    map.clear();
    map.insertBeam({0.05, 0.05, 0.95}, {0.05, 0.05, 1.05});  // in one block
  }
  EXPECT_EQ(cellAt(map, {0.05, 0.05, 1.05}), Cell::Occupied);
  map.keepAround({0, 0, 0}, MapConfig().forget_s + 1.0);
  EXPECT_EQ(map.tree().size(), 0u);
}

TEST(OccupancyMap, AllOfABeamIsForgotten) {
  OccupancyMap map(inFixedFrame(), kSmallGeometry);
  map.keepAround({0, 0, 0}, 0.0);
  map.insertBeam({1.55, 1.55, -2.05}, {1.55, 1.55, 3.15});  // the last cells of a block are in it
  map.keepAround({0, 0, 0}, MapConfig().forget_s + 1.0);
  EXPECT_EQ(map.tree().size(), 0u);
}

TEST(OccupancyMap, ACameraThatFliesOnNeedsNoMoreMemory) {
  OccupancyMap map(inFixedFrame(), kSmallGeometry);
  std::size_t most = 0, most_later = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Isometry3d T_M_C(Eigen::Translation3d(0.0, 0.0, 0.2 * i));
    map.keepAround(T_M_C.translation(), 0.1 * i);
    map.insert(wallDepth(kSmallGeometry.size(), 5.0), T_M_C);
    std::size_t& peak = i < 150 ? most : most_later;
    peak = std::max(peak, map.tree().size());
  }
  EXPECT_LT(most_later, 1.1 * most);
}

TEST(OccupancyMap, ClearingABoxLeavesItUnknown) {
  OccupancyMap map(MapConfig(), kSmallGeometry);
  map.insert(wallDepth(kSmallGeometry.size(), 4.05), Eigen::Isometry3d::Identity());
  const std::size_t all = map.tree().size();
  map.clear(Eigen::AlignedBox3d(Eigen::Vector3d::Constant(kNaN), Eigen::Vector3d::Constant(kNaN)));
  map.clear(Eigen::AlignedBox3d());
  EXPECT_EQ(map.tree().size(), all) << "a box that is none";
  map.clear(Eigen::AlignedBox3d(Eigen::Vector3d(-0.5, -0.5, 2.0), Eigen::Vector3d(0.5, 0.5, 4.5)));
  EXPECT_EQ(cellAt(map, {0.05, 0.05, 3.95}), Cell::Unknown);
  EXPECT_EQ(cellAt(map, {0.05, 0.05, 2.45}), Cell::Unknown);
  EXPECT_EQ(cellAt(map, {0.05, 0.05, 1.45}), Cell::Free);
  EXPECT_EQ(cellAt(map, {1.05, 0.05, 2.45}), Cell::Free);
}

TEST(OccupancyMap, ClearForgetsEverything) {
  OccupancyMap map(MapConfig(), kSmallGeometry);
  map.insert(wallDepth(kSmallGeometry.size(), 3.0), Eigen::Isometry3d::Identity());
  map.clear();
  EXPECT_EQ(map.tree().size(), 0u);
  EXPECT_EQ(cellAt(map, {0, 0, 2}), Cell::Unknown);
}

}  // namespace
}  // namespace flight_corridor
