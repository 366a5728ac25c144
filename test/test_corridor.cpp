#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "flight_corridor/corridor.hpp"
#include "sim/truth.hpp"

namespace flight_corridor {
namespace {

constexpr double kResolution_m = 0.1;

const auto kEverywhere = [](const Eigen::Vector3d&) { return true; };

Eigen::Isometry3d randomPose(std::mt19937& random, double reach_m) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = reach_m * Eigen::Vector3d(unit(random), unit(random), unit(random));
  pose.rotate(Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized());
  return pose;
}

/// A tree of random leaves and pruned blocks, free and occupied.
octomap::OcTree randomTree(std::mt19937& random, int cells) {
  octomap::OcTree tree(kResolution_m);
  std::uniform_int_distribution<int> near(-30, 30);
  for (int i = 0; i < cells; ++i) {
    const octomap::OcTreeKey key(static_cast<octomap::key_type>(32768 + near(random)),
                                 static_cast<octomap::key_type>(32768 + near(random)),
                                 static_cast<octomap::key_type>(32768 + near(random)));
    tree.setNodeValue(key, random() % 10 == 0 ? 1.0f : -1.0f);
  }
  return tree;
}

/// Every cell around the box, one by one.
CorridorOccupancy bruteForce(const octomap::OcTree& tree, const Box& box, double blind_m) {
  CorridorOccupancy result;
  const Eigen::Isometry3d T_F_M = box.T_M_F.inverse();
  int observable = 0, unknown = 0;
  for (int i = -80; i < 80; ++i) {
    for (int j = -80; j < 80; ++j) {
      for (int k = -80; k < 80; ++k) {
        const Eigen::Vector3d centre_M = kResolution_m * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
        if (!intersects(box, centre_M, kResolution_m)) continue;
        const Eigen::Vector3d centre_F = T_F_M * centre_M;
        const octomap::OcTreeNode* node = tree.search(centre_M.x(), centre_M.y(), centre_M.z());
        if (node && tree.isNodeOccupied(node)) {
          double nearest = kInfinity;
          for (int corner = 0; corner < 8; ++corner) {
            const Eigen::Vector3d to(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
            nearest = std::min(nearest, (T_F_M * (centre_M + 0.5 * kResolution_m * to)).x());
          }
          if (nearest >= box.size_m.x() - 1e-6) continue;
          result.clear_distance_m = std::min(result.clear_distance_m, std::max(0.0, nearest));
        }
        const bool inside = blind_m <= centre_F.x() && centre_F.x() <= box.size_m.x() &&
                            std::abs(centre_F.y()) <= 0.5 * box.size_m.y() &&
                            std::abs(centre_F.z()) <= 0.5 * box.size_m.z();
        observable += inside;
        unknown += inside && !node;
      }
    }
  }
  result.unknown_fraction = observable ? unknown / static_cast<double>(observable) : 1.0;
  return result;
}

TEST(Corridor, AgreesWithALoopOverAllCells) {
  CorridorConfig config;
  config.blind_m = 0.3;
  const Corridor corridor(config);
  std::mt19937 random(21);
  for (int trial = 0; trial < 5; ++trial) {
    const octomap::OcTree tree = randomTree(random, trial % 2 ? 400 : 40000);
    const Box box = corridor.box(randomPose(random, 1.0));
    const CorridorOccupancy fast = corridor.inspect(tree, box, kEverywhere),
                            slow = bruteForce(tree, box, config.blind_m);
    if (std::isfinite(slow.clear_distance_m)) {
      EXPECT_NEAR(fast.clear_distance_m, slow.clear_distance_m, 1e-9) << "trial " << trial;
    } else {
      EXPECT_EQ(fast.clear_distance_m, kInfinity) << "trial " << trial;
    }
    EXPECT_NEAR(fast.unknown_fraction, slow.unknown_fraction, 1e-12) << "trial " << trial;
  }
}

TEST(Corridor, BoxAndCubeMeetExactlyWhenASharedPointExists) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int met = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Box box;
    box.T_M_F = randomPose(random, 0.5);
    box.size_m = {1.0, 0.6, 0.3};
    const Eigen::Vector3d centre(unit(random), unit(random), unit(random));
    const auto cube = [&](double edge) {
      return sim::makeBox(centre, Eigen::Vector3d::Constant(edge), sim::Material());
    };
    // The simulation's test is another algorithm, exact to 1e-6 m: between a slightly smaller and larger cube both
    // agree.
    const bool surely = sim::overlaps(box.T_M_F, box.size_m, cube(0.4 - 1e-4));
    const bool possibly = sim::overlaps(box.T_M_F, box.size_m, cube(0.4 + 1e-4));
    const bool answer = intersects(box, centre, 0.4);
    EXPECT_TRUE(answer || !surely) << "trial " << trial;
    EXPECT_TRUE(!answer || possibly) << "trial " << trial;
    met += answer;
  }
  EXPECT_GT(met, 100);
  EXPECT_LT(met, 1900);
}

TEST(Corridor, AnEmptyMapIsUnknownAltogether) {
  const Corridor corridor((CorridorConfig()));
  const CorridorOccupancy occupancy =
      corridor.inspect(octomap::OcTree(kResolution_m), corridor.box(Eigen::Isometry3d::Identity()), kEverywhere);
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
  const CorridorOccupancy here = corridor.inspect(tree, corridor.box(Eigen::Isometry3d::Identity()), kEverywhere);
  const CorridorOccupancy there = corridor.inspect(moved, corridor.box(shift), kEverywhere);
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
        corridor.inspect(tree, corridor.box(Eigen::Isometry3d::Identity()), kEverywhere).clear_distance_m;
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
        corridor.inspect(tree, corridor.box(Eigen::Isometry3d::Identity()), kEverywhere).clear_distance_m;
    EXPECT_LE(clear, before) << "margin " << margin;
    before = clear;
  }
}

TEST(Corridor, CellsBesideTheBoxBlockItCellsBehindItsEndDoNot) {
  const Corridor corridor((CorridorConfig()));
  const auto clear = [&](float x, float y) {
    octomap::OcTree tree(kResolution_m);
    tree.setNodeValue(octomap::point3d(x, y, 0.05f), 1.0f);
    return corridor.inspect(tree, corridor.box(Eigen::Isometry3d::Identity()), kEverywhere).clear_distance_m;
  };
  EXPECT_NEAR(clear(2.05f, 0.65f), 2.0, 1e-6);  // 0.6 to 0.7 m to the left: touches
  EXPECT_EQ(clear(2.05f, 0.75f), kInfinity);
  EXPECT_NEAR(clear(3.95f, 0.05f), 3.9, 1e-6);
  EXPECT_EQ(clear(4.05f, 0.05f), kInfinity);
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
  const auto beyond_two = [](const Eigen::Vector3d& p_M) { return p_M.x() > 2.0; };
  const Box box = corridor.box(Eigen::Isometry3d::Identity());
  EXPECT_EQ(corridor.inspect(tree, box, beyond_two).unknown_fraction, 0.0);
  EXPECT_GT(corridor.inspect(tree, box, kEverywhere).unknown_fraction, 0.4);
}

}  // namespace
}  // namespace flight_corridor
