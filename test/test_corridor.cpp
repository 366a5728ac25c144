#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/map/box_cells.hpp"
#include "support/random_octree.hpp"
#include "support/random_pose.hpp"

namespace flight_corridor {
namespace {

using test_support::keyOf;
using test_support::kResolution_m;
using test_support::randomPose;
using test_support::randomTree;

Box corridorAhead(const CorridorConfig& config = {}) { return corridorBox(config, Eigen::Isometry3d::Identity()); }

struct BoxCells {
  double clear_distance_m = kInfinity;
  double unknown_fraction = 1.0;
};

BoxCells cellsIn(const octomap::OcTree& tree, const Box& box) {
  return {nearestOccupied(tree, box).clear_distance_m, unknownFraction(tree, box)};
}

/// Asks the tree about every cell that may be centred in a box.
BoxCells oracle(const octomap::OcTree& tree, const Box& box, int reach_cells) {
  BoxCells cells;
  const Eigen::Vector3d forward_M = box.T_M_F.linear().col(0);
  int known = 0;
  for (int x = -reach_cells; x <= reach_cells; ++x) {
    for (int y = -reach_cells; y <= reach_cells; ++y) {
      for (int z = -reach_cells; z <= reach_cells; ++z) {
        const Eigen::Vector3d cell_M = kResolution_m * (Eigen::Vector3d(x, y, z).array() + 0.5);
        const octomap::OcTreeNode* node = contains(box, cell_M) ? tree.search(keyOf(x, y, z)) : nullptr;
        if (!node) continue;
        ++known;
        if (!tree.isNodeOccupied(node)) continue;
        const double begin_m =
            forward_M.dot(cell_M - box.T_M_F.translation()) - 0.5 * kResolution_m * forward_M.lpNorm<1>();
        cells.clear_distance_m = std::min(cells.clear_distance_m, std::max(0.0, begin_m));
      }
    }
  }
  cells.unknown_fraction = std::max(0.0, 1.0 - known * std::pow(kResolution_m, 3) / box.size_m.prod());
  return cells;
}

TEST(Corridor, WhatItsCellsSayIsWhatAskingEachOfThemSays) {
  std::mt19937 random(11);
  octomap::OcTree tree = randomTree(random, 3000);
  for (int x = 8; x < 16; ++x) {
    for (int y = -8; y < 0; ++y) {
      for (int z = 0; z < 8; ++z) tree.setNodeValue(keyOf(x, y, z), 1.0f);
    }
  }
  tree.prune();  // that is one leaf now
  int occupied = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const Box box{randomPose(random, 1.0), {1.5, 0.8, 0.5}};
    const BoxCells cells = cellsIn(tree, box), expected = oracle(tree, box, 30);
    if (std::isfinite(expected.clear_distance_m)) {
      EXPECT_NEAR(cells.clear_distance_m, expected.clear_distance_m, 1e-5) << trial;
    } else {
      EXPECT_EQ(cells.clear_distance_m, kInfinity) << trial;
    }
    EXPECT_NEAR(cells.unknown_fraction, expected.unknown_fraction, 1e-9) << trial;
    occupied += std::isfinite(expected.clear_distance_m);
  }
  EXPECT_GT(occupied, 10);
}

TEST(Corridor, ABoxThatReachesOutOfTheOctreeIsUnknown) {
  octomap::OcTree tree(kResolution_m);
  tree.setNodeValue(keyOf(32767, 0, 0), -1.0f);
  Box box;
  box.T_M_F.translation() = kResolution_m * Eigen::Vector3d(32767.1, 0.5, 0.5);
  box.size_m = kResolution_m * Eigen::Vector3d(1.4, 1.0, 1.0);
  EXPECT_EQ(cellsIn(tree, box).unknown_fraction, 1.0);
  box.T_M_F.translation().x() = 1e300;
  EXPECT_EQ(cellsIn(tree, box).unknown_fraction, 1.0);
}

TEST(Corridor, AnEmptyTreeIsUnknownAltogether) {
  const BoxCells cells = cellsIn(octomap::OcTree(kResolution_m), corridorAhead());
  EXPECT_EQ(cells.unknown_fraction, 1.0);
  EXPECT_EQ(cells.clear_distance_m, kInfinity);
}

TEST(Corridor, MovingTreeAndBoxTogetherKeepsTheAnswer) {
  std::mt19937 random(8);
  const octomap::OcTree tree = randomTree(random, 30000);
  octomap::OcTree moved(kResolution_m);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    ASSERT_EQ(leaf.getDepth(), tree.getTreeDepth()) << "not pruned";
    octomap::OcTreeKey key = leaf.getKey();
    key[0] = static_cast<octomap::key_type>(key[0] + 7);
    moved.setNodeValue(key, leaf->getLogOdds());
  }
  const Box here = corridorAhead();
  const Box there{Eigen::Translation3d(7 * kResolution_m, 0.0, 0.0) * here.T_M_F, here.size_m};
  const BoxCells one = cellsIn(tree, here), other = cellsIn(moved, there);
  EXPECT_NEAR(one.clear_distance_m, other.clear_distance_m, 1e-6);
  EXPECT_NEAR(one.unknown_fraction, other.unknown_fraction, 1e-9);
}

TEST(Corridor, AnOccupiedCellMoreNeverLengthensTheClearDistance) {
  std::mt19937 random(9);
  octomap::OcTree tree(kResolution_m);
  double before = kInfinity;
  std::uniform_real_distribution<float> forward(0.0f, 5.0f), side(-1.0f, 1.0f);
  for (int i = 0; i < 200; ++i) {
    tree.setNodeValue(octomap::point3d(forward(random), side(random), side(random)), 1.0f);
    const double after = cellsIn(tree, corridorAhead()).clear_distance_m;
    EXPECT_LE(after, before);
    before = after;
  }
  EXPECT_LT(before, 4.0);
}

TEST(Corridor, AWiderBoxNeverHasALongerClearDistance) {
  std::mt19937 random(10);
  const octomap::OcTree tree = randomTree(random, 3000);
  double before = kInfinity;
  for (const double margin : {0.0, 0.05, 0.2, 0.7}) {
    CorridorConfig config;
    config.margin_m = margin;
    const double clear = cellsIn(tree, corridorAhead(config)).clear_distance_m;
    EXPECT_LE(clear, before) << "margin " << margin;
    before = clear;
  }
}

TEST(Corridor, WhatIsCentredBesideTheBoxOrBehindItsEndIsNotInIt) {
  const auto clear = [](float x, float y) {
    octomap::OcTree tree(kResolution_m);
    tree.setNodeValue(octomap::point3d(x, y, 0.05f), 1.0f);
    return cellsIn(tree, corridorAhead()).clear_distance_m;
  };
  EXPECT_NEAR(clear(2.05f, 0.55f), 2.0, 1e-6);
  EXPECT_EQ(clear(2.05f, 0.65f), kInfinity);
  EXPECT_NEAR(clear(3.95f, 0.05f), 3.9, 1e-6);
  EXPECT_EQ(clear(4.05f, 0.05f), kInfinity);
}

TEST(Corridor, ASmallerObstacleThanUsualIsAskedForAsItIsConfigured) {
  CorridorConfig config;
  config.smallest_obstacle_m = 0.02;
  EXPECT_EQ(smallestInspected(config), 0.02);
  config.smallest_obstacle_m = 0.0;
  EXPECT_EQ(smallestInspected(config), 0.01);
}

TEST(Corridor, TheOffsetShiftsTheBoxForwardLeftAndUpTheMarginWidensIt) {
  CorridorConfig config;
  config.offset_m = {0.5, 0.2, -0.1};
  EXPECT_TRUE(corridorAhead(config).T_M_F.translation().isApprox(config.offset_m));
  config.margin_m = 0.25;
  EXPECT_TRUE(corridorAhead(config).size_m.isApprox(Eigen::Vector3d(4.25, 1.7, 0.9)));
  EXPECT_TRUE(corridorAhead(config).T_M_F.translation().isApprox(config.offset_m)) << "it still begins there";
}

}  // namespace
}  // namespace flight_corridor
