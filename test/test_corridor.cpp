#include <gtest/gtest.h>

#include <random>

#include "flight_corridor/corridor/corridor.hpp"
#include "support/random_octree.hpp"

namespace flight_corridor {
namespace {

using test_support::kEverywhere;
using test_support::keyOf;
using test_support::kResolution_m;
using test_support::randomTree;

const Eigen::Vector3d kCamera(0, 0, 0);

TEST(Corridor, CellsCentredOnTheBoxesFacesCount) {
  octomap::OcTree tree(kResolution_m);
  tree.setNodeValue(keyOf(10, 0, 0), -1.0f);
  Box box;  // from the centre of one cell to that of the next but one, one row of cells wide
  box.T_M_F.translation() = kResolution_m * Eigen::Vector3d(10.5, 0.5, 0.5);
  box.size_m = {2.0 * kResolution_m, kResolution_m, kResolution_m};
  EXPECT_EQ(inspectBox(tree, box, kEverywhere).unknown_fraction, 2.0 / 3.0);
}

TEST(Corridor, ABoxThatReachesOutOfTheOctreeIsUnknown) {
  octomap::OcTree tree(kResolution_m);
  tree.setNodeValue(keyOf(32767, 0, 0), -1.0f);
  Box box;  // in that last cell
  box.T_M_F.translation() = kResolution_m * Eigen::Vector3d(32767.1, 0.5, 0.5);
  box.size_m = kResolution_m * Eigen::Vector3d(0.8, 1.0, 1.0);
  EXPECT_EQ(inspectBox(tree, box, kEverywhere).unknown_fraction, 0.0);
  box.size_m.x() += 0.5 * kResolution_m;
  EXPECT_EQ(inspectBox(tree, box, kEverywhere).unknown_fraction, 1.0);
  box.T_M_F.translation().x() = 1e300;
  EXPECT_EQ(inspectBox(tree, box, kEverywhere).unknown_fraction, 1.0);
}

TEST(Corridor, AnEmptyMapIsUnknownAltogether) {
  const Corridor corridor((CorridorConfig()));
  const CorridorOccupancy occupancy = corridor.inspect(
      octomap::OcTree(kResolution_m), corridor.box(Eigen::Isometry3d::Identity()), kCamera, kEverywhere);
  EXPECT_EQ(occupancy.unknown_fraction, 1.0);
  EXPECT_EQ(occupancy.clear_distance_m, kInfinity);
}

TEST(Corridor, MovingMapAndBoxTogetherKeepsTheAnswer) {
  const Corridor corridor((CorridorConfig()));
  std::mt19937 random(8);
  const octomap::OcTree tree = randomTree(random, 30000);
  octomap::OcTree moved(kResolution_m);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    octomap::OcTreeKey key = leaf.getKey();
    if (leaf.getDepth() != tree.getTreeDepth()) continue;  // blocks are rare here and stay away
    key[0] = static_cast<octomap::key_type>(key[0] + 7);
    moved.setNodeValue(key, leaf->getLogOdds());
  }
  Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
  shift.translation().x() = 7 * kResolution_m;
  const CorridorOccupancy here =
      corridor.inspect(tree, corridor.box(Eigen::Isometry3d::Identity()), kCamera, kEverywhere);
  const CorridorOccupancy there = corridor.inspect(moved, corridor.box(shift), shift.translation(), kEverywhere);
  EXPECT_NEAR(here.clear_distance_m, there.clear_distance_m, 1e-9);
}

TEST(Corridor, AddingAnObstacleNeverLengthensTheClearDistance) {
  const Corridor corridor((CorridorConfig()));
  std::mt19937 random(9);
  octomap::OcTree tree(kResolution_m);
  double before = kInfinity;
  std::uniform_real_distribution<float> ahead(0.0f, 5.0f), side(-1.0f, 1.0f);
  for (int i = 0; i < 200; ++i) {
    tree.setNodeValue(octomap::point3d(ahead(random), side(random), side(random)), 1.0f);
    const double after =
        corridor.inspect(tree, corridor.box(Eigen::Isometry3d::Identity()), kCamera, kEverywhere).clear_distance_m;
    EXPECT_LE(after, before);
    before = after;
  }
  EXPECT_LT(before, 4.0);
}

TEST(Corridor, WideningTheBoxNeverImprovesTheAnswer) {
  std::mt19937 random(10);
  const octomap::OcTree tree = randomTree(random, 3000);
  double before = kInfinity;
  for (const double margin : {0.0, 0.05, 0.2, 0.7}) {
    CorridorConfig config;
    config.margin_m = margin;
    const Corridor corridor(config);
    const double clear =
        corridor.inspect(tree, corridor.box(Eigen::Isometry3d::Identity()), kCamera, kEverywhere).clear_distance_m;
    EXPECT_LE(clear, before) << "margin " << margin;
    before = clear;
  }
}

TEST(Corridor, CellsBesideTheBoxBlockItCellsBehindItsEndDoNot) {
  const Corridor corridor((CorridorConfig()));
  const auto clear = [&](float x, float y) {
    octomap::OcTree tree(kResolution_m);
    tree.setNodeValue(octomap::point3d(x, y, 0.05f), 1.0f);
    return corridor.inspect(tree, corridor.box(Eigen::Isometry3d::Identity()), kCamera, kEverywhere).clear_distance_m;
  };
  EXPECT_NEAR(clear(2.05f, 0.65f), 2.0, 1e-6);  // 0.6 to 0.7 m to the left: touches
  EXPECT_EQ(clear(2.05f, 0.75f), kInfinity);
  EXPECT_NEAR(clear(3.95f, 0.05f), 3.9, 1e-6);
  EXPECT_EQ(clear(4.05f, 0.05f), kInfinity);
}

TEST(Corridor, WhatCellsHoldDecidesWhereTheyBegin) {
  octomap::OcTree tree(kResolution_m);
  for (const float x : {1.05f, 2.05f, 2.15f, 3.05f}) tree.setNodeValue(octomap::point3d(x, 0.05f, 0.05f), 1.0f);
  const Box box = Corridor(CorridorConfig()).box(Eigen::Isometry3d::Identity());
  const auto begin = [](const Eigen::Vector3d& cell_centre_M, double near_m) {
    EXPECT_NEAR(near_m, cell_centre_M.x() - 0.05, 1e-6);
    if (cell_centre_M.x() < 2.0) return kInfinity;                   // nothing in the box
    return cell_centre_M.x() < 2.1 ? near_m + 0.15 : near_m + 0.01;  // 2.15 m and 2.11 m
  };
  EXPECT_NEAR(inspectBox(tree, box, kEverywhere, begin).clear_distance_m, 2.11, 1e-6);
  EXPECT_NEAR(inspectBox(tree, box, kEverywhere).clear_distance_m, 1.0, 1e-6);
}

TEST(Corridor, OffsetShiftsTheBoxForwardLeftAndUp) {
  CorridorConfig config;
  config.offset_m = {0.5, 0.2, -0.1};
  const Box box = Corridor(config).box(Eigen::Isometry3d::Identity());
  EXPECT_TRUE(box.T_M_F.translation().isApprox(config.offset_m));
}

TEST(Corridor, CellsThatNobodyCanObserveAreNotMissed) {
  const Corridor corridor((CorridorConfig()));
  octomap::OcTree tree(kResolution_m);
  for (float x = 2.05f; x < 4.0f; x += 0.1f) {
    for (float y = -0.65f; y < 0.7f; y += 0.1f) {
      for (float z = -0.25f; z < 0.3f; z += 0.1f) tree.setNodeValue(octomap::point3d(x, y, z), -1.0f);
    }
  }
  const ConvexRegion beyond_two = Eigen::Vector4d(1.0, 0.0, 0.0, -2.0);
  const Box box = corridor.box(Eigen::Isometry3d::Identity());
  EXPECT_EQ(corridor.inspect(tree, box, kCamera, beyond_two).unknown_fraction, 0.0);
  EXPECT_GT(corridor.inspect(tree, box, kCamera, kEverywhere).unknown_fraction, 0.4);
  const Eigen::Vector3d before_two_C = Eigen::Vector3d(2.0 - CorridorConfig().blind_m, 0.0, 0.0);
  EXPECT_EQ(corridor.inspect(tree, box, before_two_C, kEverywhere).unknown_fraction, 0.0);  // too near to the camera
}

TEST(Corridor, AnEndThatNobodyCanObserveIsMissed) {
  const Corridor corridor((CorridorConfig()));
  octomap::OcTree tree(kResolution_m);
  for (float x = 0.45f; x < 4.0f; x += 0.1f) {
    for (float z = -0.25f; z < 0.3f; z += 0.1f) tree.setNodeValue(octomap::point3d(x, 0.55f, z), -1.0f);
  }
  const ConvexRegion left_edge = Eigen::Vector4d(0.0, 1.0, 0.0, -0.5);
  const Box box = corridor.box(Eigen::Isometry3d::Identity());
  EXPECT_GT(corridor.inspect(tree, box, kCamera, left_edge).unknown_fraction, 0.5);
  const ConvexRegion most = Eigen::Vector4d(0.0, 1.0, 0.0, 0.2);  // of the end 0.8 m of 1.2 m, none of it known
  EXPECT_NEAR(corridor.inspect(tree, box, kCamera, most).unknown_fraction, 7.0 / 8.0, 1e-9) << "the rest is not missed";
  const ConvexRegion needed = intersection(left_edge, beyond(box, CorridorConfig().blind_m));
  EXPECT_EQ(inspectBox(tree, box, needed).unknown_fraction, 0.0);
}

}  // namespace
}  // namespace flight_corridor
