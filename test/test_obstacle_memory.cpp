#include <gtest/gtest.h>

#include <vector>

#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/map/obstacle_memory.hpp"

namespace flight_corridor {
namespace {

const Eigen::Vector3d kPlace(2.04, 0.03, 0.06);

Sight nothing(const Eigen::Vector3d&) { return Sight::Nothing; }
Sight clearThere(const Eigen::Vector3d&) { return Sight::Clear; }
Sight unclear(const Eigen::Vector3d&) { return Sight::Unclear; }

bool isOccupied(const ObstacleMemory& memory, const Eigen::Vector3d& at = kPlace) {
  const octomap::OcTreeNode* node = memory.tree().search(at.x(), at.y(), at.z());
  return node && memory.tree().isNodeOccupied(node);
}

TEST(ObstacleMemory, EveryCellThatAPatchTouchesIsOccupied) {
  ObstacleMemory memory{MapConfig()};
  std::vector<Eigen::Vector3d> ball;  // of 7 cm, about a corner of eight cells
  for (const double x : {-0.035, 0.035}) {
    for (const double y : {-0.035, 0.035}) {
      for (const double z : {-0.035, 0.035}) ball.emplace_back(2.0 + x, y, z);
    }
  }
  memory.add(ball, 1.0);
  for (const Eigen::Vector3d& p : ball) EXPECT_TRUE(isOccupied(memory, p)) << p.transpose();
}

TEST(ObstacleMemory, WhatNoPairShowsAnyMoreStays) {
  ObstacleMemory memory{MapConfig()};
  memory.add({kPlace}, 1.0);
  for (int i = 1; i <= 20; ++i) memory.update(1.0 + 0.1 * i, nothing);
  EXPECT_TRUE(isOccupied(memory));
}

TEST(ObstacleMemory, TwoPairsThatSeeThroughACellFreeIt) {
  ObstacleMemory memory{MapConfig()};
  memory.add({kPlace}, 1.0);
  memory.update(1.1, clearThere);
  EXPECT_TRUE(isOccupied(memory));
  memory.update(1.2, clearThere);
  EXPECT_FALSE(isOccupied(memory));
}

TEST(ObstacleMemory, WhatIsUnclearIsNoReasonToForget) {
  ObstacleMemory memory{MapConfig()};
  memory.add({kPlace}, 1.0);
  for (int i = 1; i <= 5; ++i) memory.update(1.0 + 0.1 * i, unclear);
  EXPECT_TRUE(isOccupied(memory));
}

TEST(ObstacleMemory, OldCellsAreForgotten) {
  MapConfig config;
  ObstacleMemory memory{config};
  memory.add({kPlace}, 1.0);
  memory.update(1.0 + config.forget_s + 0.1, nothing);
  EXPECT_FALSE(isOccupied(memory));
}

TEST(ObstacleMemory, ABoxOfItIsCleared) {
  ObstacleMemory memory{MapConfig()};
  const Eigen::Vector3d other(3.04, 0.03, 0.06);
  memory.add({kPlace, other}, 1.0);
  memory.clear(Eigen::AlignedBox3d(Eigen::Vector3d(1.9, -0.1, -0.1), Eigen::Vector3d(2.2, 0.2, 0.2)));
  EXPECT_FALSE(isOccupied(memory));
  EXPECT_TRUE(isOccupied(memory, other));
  memory.clear();
  EXPECT_FALSE(isOccupied(memory, other));
}

TEST(ObstacleMemory, PlacesWithoutAKeyAreLeftOut) {
  ObstacleMemory memory{MapConfig()};
  memory.add({{1e9, 0.0, 0.0}, {kNaN, 0.0, 0.0}}, 1.0);
  EXPECT_EQ(memory.tree().size(), 0u);
}

}  // namespace
}  // namespace flight_corridor
