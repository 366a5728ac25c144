#include <gtest/gtest.h>

#include <cmath>

#include "sim/closed_loop.hpp"
#include "sim/corridor_rule.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

/// Ground and a house far away; the goal is 6 m ahead.
World plainWorld() {
  Random random(5, Stream::Scene);
  World world;
  world.scene.rig = defaultRig();
  addGround(1.0, world.scene, random);
  world.scene.world.push_back(backdrop(14.0, masonry(random)));
  world.goal_W = {6.0, 0.0, 1.5};
  return world;
}

World trunkWorld() {
  World world = plainWorld();
  Random random(6, Stream::Scene);
  world.scene.world.push_back(uprightPole(5.0, 0.0, 0.2, 5.0, bark(random)));
  world.goal_W.x() = 9.0;
  return world;
}

ClosedLoopOptions quick() {
  ClosedLoopOptions options;
  options.image_scale = 0.25;
  options.patience_s = 20.0;
  return options;
}

Way straightOn(const Observation&) { return {Eigen::Vector3d::UnitX(), 4.0, 4.0}; }

TEST(ClosedLoop, ReachesAGoalStraightAhead) {
  const Flown flown = ClosedLoop(plainWorld(), quick(), 1).fly(straightOn);
  EXPECT_EQ(flown.ending, Ending::Goal);
  EXPECT_NEAR(flown.distance_m, 4.5, 0.1);  // 1.5 m before the goal it has arrived
  EXPECT_GT(flown.top_speed_mps, 1.5);
  EXPECT_NEAR(flown.nearest_m, 1.3, 0.15);  // the ground, below the tilted airframe
  EXPECT_FALSE(flown.hit);
}

TEST(ClosedLoop, ACollisionEndsTheFlightAtWhatIsHit) {
  const Flown flown = ClosedLoop(trunkWorld(), quick(), 1).fly(straightOn);
  EXPECT_EQ(flown.ending, Ending::Collision);
  EXPECT_EQ(flown.nearest_m, 0.0);
  ASSERT_TRUE(flown.hit);
  EXPECT_EQ(flown.hit->shape, Shape::Cylinder);
  EXPECT_NEAR(flown.distance_m, 5.0 - 0.2 - 0.25, 0.1);
  EXPECT_GT(flown.hit_speed_mps, 1.5);
  EXPECT_LE(flown.out_of_view_s, 0.15);  // the trunk was ahead in the last pair
  EXPECT_EQ(flown.fault, Fault::Own);
}

TEST(ClosedLoop, TellsForHowLongWhatWasHitHadBeenOutOfView) {
  World world = plainWorld();
  Random random(6, Stream::Scene);
  world.scene.world.push_back(uprightPole(0.0, 3.0, 0.2, 5.0, bark(random)));
  world.scene.world.back().velocity_W.y() = -1.0;  // from beside, into the UAV that waits
  const Way waits{Eigen::Vector3d::UnitX(), 0.0, 0.0};
  const Flown flown = ClosedLoop(world, quick(), 1).fly([&](const Observation&) { return waits; });
  ASSERT_TRUE(flown.hit);
  EXPECT_EQ(flown.out_of_view_s, kInfinity);
  EXPECT_LT(flown.hit_speed_mps, 0.05);
  EXPECT_EQ(flown.fault, Fault::AtRest);
}

TEST(ClosedLoop, GivesUpWhereThereIsNoWay) {
  ClosedLoopOptions options = quick();
  options.patience_s = 3.0;
  const Flown flown = ClosedLoop(plainWorld(), options, 1).fly([](const Observation&) { return Way(); });
  EXPECT_EQ(flown.ending, Ending::GivenUp);
  EXPECT_EQ(flown.distance_m, 0.0);
  EXPECT_NEAR(flown.waited_s, 3.0, 0.2);
}

TEST(ClosedLoop, HandsOutPairsAndReadingsInTheOrderOfTime) {
  double last_s = -kInfinity;
  int pairs = 0, ranges = 0;
  ClosedLoop loop(plainWorld(), quick(), 1);
  loop.fly([&](const Observation& seen) {
    for (const RangeReading& reading : seen.ranges) {
      EXPECT_GT(reading.stamp_s, last_s);
      EXPECT_LE(reading.stamp_s, seen.pair.stamp_s + 1e-9);
      last_s = reading.stamp_s;
      ++ranges;
    }
    EXPECT_EQ(seen.pair.left.size(), loop.calibration().size_px);
    ++pairs;
    return straightOn(seen);
  });
  EXPECT_GT(pairs, 20);
  EXPECT_GT(ranges, 4 * pairs);
}

TEST(ClosedLoop, TheSameSeedGivesTheSameFlight) {
  const auto fly = [](std::uint64_t seed) {
    ClosedLoop loop(trunkWorld(), quick(), seed);
    Config config;
    config.stereo.num_disparities_px = 32;
    config.corridor.smallest_obstacle_m = 0.15;
    CorridorRule rule(config, loop);
    return loop.fly([&](const Observation& seen) { return rule.judge(seen); });
  };
  const Flown once = fly(3), again = fly(3);
  EXPECT_GT(once.distance_m, 1.0);
  EXPECT_EQ(once.distance_m, again.distance_m);
  EXPECT_EQ(once.ending, again.ending);
}

TEST(CorridorRule, FliesRoundATrunk) {
  ClosedLoopOptions options = quick();
  options.image_scale = 0.5;
  ClosedLoop loop(trunkWorld(), options, 2);
  Config config;
  config.stereo.num_disparities_px = 64;
  config.corridor.smallest_obstacle_m = 0.08;
  CorridorRule rule(config, loop);
  const Flown flown = loop.fly([&](const Observation& seen) { return rule.judge(seen); });
  EXPECT_EQ(flown.ending, Ending::Goal);
  EXPECT_GT(flown.nearest_m, 0.1);
}

TEST(LevelFrame, IsLevelAlongTheHeadingAtTheCamera) {
  const Eigen::Isometry3d T_W_B(Eigen::Translation3d(1.0, 2.0, 3.0) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()));
  const Eigen::Isometry3d T_W_F = levelFrame(T_W_B, defaultRig().T_B_C);
  EXPECT_TRUE(T_W_F.linear().isApprox(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
  EXPECT_TRUE(T_W_F.translation().isApprox(T_W_B * defaultRig().T_B_C.translation()));
}

}  // namespace
}  // namespace flight_corridor::sim
