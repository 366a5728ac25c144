#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "sim/truth.hpp"
#include "sim/worlds.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kBodyWidth_m = 1.5, kBodyHeight_m = 0.7;  // of the corridor, and 0.3 m more

/// Nothing but ground, and a wall across at x = 10 m.
World walledWorld() {
  World world;
  world.scene.world.push_back(makeBox({0, 0, -0.5}, {300, 300, 1}, {}));
  world.scene.world.push_back(makeBox({10, 0, 2}, {0.2, 30, 4}, {}));
  return world;
}

/// Leaves an opening in the wall about y = 3 m.
World openedWorld(double opening_m) {
  World world = walledWorld();
  world.scene.world.pop_back();
  for (const double side : {-1.0, 1.0}) {
    world.scene.world.push_back(makeBox({10.0, 3.0 + side * (20.0 + opening_m) / 2.0, 2.0}, {0.2, 20.0, 4.0}, {}));
  }
  return world;
}

TEST(Worlds, AreKnownByTheirNames) {
  const std::vector<std::string> names = worldNames();
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  EXPECT_GE(names.size(), 12u);
  try {
    makeWorld("atlantis", 0);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'atlantis'; known are: alley"), std::string::npos);
  }
}

TEST(Worlds, TheSameSeedGivesTheSameWorldAndAnotherSeedAnother) {
  for (const std::string& name : worldNames()) {
    const World once = makeWorld(name, 3), again = makeWorld(name, 3), other = makeWorld(name, 4);
    ASSERT_EQ(once.scene.world.size(), again.scene.world.size()) << name;
    for (std::size_t i = 0; i < once.scene.world.size(); ++i) {
      EXPECT_TRUE(once.scene.world[i].T_W_O.isApprox(again.scene.world[i].T_W_O, 0.0)) << name << ' ' << i;
      EXPECT_EQ(once.scene.world[i].half_m, again.scene.world[i].half_m) << name << ' ' << i;
      EXPECT_EQ(once.scene.world[i].material.seed, again.scene.world[i].material.seed) << name << ' ' << i;
    }
    EXPECT_EQ(once.goal_W, again.goal_W) << name;
    EXPECT_NE(once.goal_W, other.goal_W) << name;
  }
}

TEST(Worlds, LeaveRoomAtTheStartAndHaveTheirGoalTwentyMetresAway) {
  for (const std::string& name : worldNames()) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const World world = makeWorld(name, seed);
      Eigen::Isometry3d T_W_F = Eigen::Isometry3d::Identity();
      T_W_F.translation() = world.scene.flight.start_W - Eigen::Vector3d(0.75, 0.0, 0.0);
      for (const Primitive& primitive : visibleAt(world.scene.world, 0.0)) {
        EXPECT_FALSE(overlaps(T_W_F, {kBodyWidth_m, kBodyWidth_m, kBodyHeight_m}, primitive)) << name << ' ' << seed;
      }
      EXPECT_GE((world.goal_W - world.scene.flight.start_W).norm(), 20.0) << name << ' ' << seed;
      EXPECT_TRUE(world.ground_W.contains(Eigen::Vector2d(world.goal_W.head<2>()))) << name << ' ' << seed;
    }
  }
}

TEST(Worlds, MostlyHaveAWay) {
  for (const std::string& name : worldNames()) {
    int ways = 0;
    for (std::uint64_t seed = 0; seed < 5; ++seed)
      ways += wayExists(makeWorld(name, seed), kBodyWidth_m, kBodyHeight_m);
    EXPECT_GE(ways, 2) << name;
  }
}

TEST(WayExists, NotThroughAWall) {
  EXPECT_FALSE(wayExists(walledWorld(), kBodyWidth_m, kBodyHeight_m));
  World open = walledWorld();
  open.scene.world.pop_back();
  EXPECT_TRUE(wayExists(open, kBodyWidth_m, kBodyHeight_m));
}

TEST(WayExists, ThroughAnOpeningThatIsWideEnough) {
  EXPECT_TRUE(wayExists(openedWorld(1.75), kBodyWidth_m, kBodyHeight_m));
  EXPECT_FALSE(wayExists(openedWorld(1.45), kBodyWidth_m, kBodyHeight_m));
}

TEST(WayExists, ThroughAWindowThatIsHighEnough) {
  for (const double half_m : {0.3, 0.4}) {
    World world = openedWorld(2.0);
    world.scene.world.push_back(makeBox({10, 3, (1.5 - half_m) / 2.0}, {0.2, 2.0, 1.5 - half_m}, {}));
    world.scene.world.push_back(makeBox({10, 3, 3.0 + half_m}, {0.2, 2.0, 3.0}, {}));
    EXPECT_EQ(wayExists(world, kBodyWidth_m, kBodyHeight_m), half_m > kBodyHeight_m / 2.0) << half_m;
  }
}

TEST(WayExists, WhateverMovesDoesNotCount) {
  World world = walledWorld();
  world.scene.world.back().velocity_W = {0.0, 0.1, 0.0};
  EXPECT_TRUE(wayExists(world, kBodyWidth_m, kBodyHeight_m));
}

TEST(GapBetween, IsTheDistance) {
  const Eigen::Isometry3d T_W_F(Eigen::Translation3d(-0.5, 0.0, 0.0));  // the box about the origin
  const Eigen::Vector3d size_m(1.0, 1.0, 1.0);
  EXPECT_NEAR(gapBetween(T_W_F, size_m, makeBox({3, 0, 0}, {1, 1, 1}, {})), 2.0, 1e-3);
  EXPECT_NEAR(gapBetween(T_W_F, size_m, makeBox({2, 3, 0}, {1, 1, 1}, {})), std::hypot(1.0, 2.0), 1e-3);
  EXPECT_NEAR(gapBetween(T_W_F, size_m, makeSphere({0, 0, 2}, 0.3, {})), 1.2, 1e-3);
  EXPECT_NEAR(gapBetween(T_W_F, size_m, makeCylinder({2, -5, 0}, {2, 5, 0}, 0.2, {})), 1.3, 1e-3);
  EXPECT_NEAR(gapBetween(T_W_F, size_m, makeSphere({0.4, 0, 0}, 0.3, {})), 0.0, 1e-6);
}

}  // namespace
}  // namespace flight_corridor::sim
