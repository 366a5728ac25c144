#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "flight_corridor/map/box_cells.hpp"
#include "flight_corridor/pipeline.hpp"
#include "sim/rig.hpp"
#include "sim/simulation.hpp"
#include "sim/still.hpp"
#include "support/masonry.hpp"

// What earlier pairs have shown, in the verdict on the newest.

namespace flight_corridor {
namespace {

using test_support::cubeAt;
using test_support::masonryAt;

StereoGeometry rigGeometry() { return StereoGeometry(sim::defaultRig().calibration); }

/// Pairs of one still scene, each with its own noise.
StereoFrame pairOf(const std::vector<sim::Primitive>& world, int index) {
  StereoFrame pair = sim::stillPair(world, static_cast<std::uint64_t>(1 + index));
  pair.stamp_s = 1.0 + 0.2 * index;
  return pair;
}

/// States of a flight, with its poses told, shown by the images alone, or with no memory.
struct FlightCounts {
  int free = 0, unknown = 0, blocked = 0, wrong_free = 0;
};
enum class Motion { Told, ByImages, Unused };
FlightCounts flyWith(const std::string& scene, Motion motion) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = 9101;
  options.rate_hz = 5.0;
  const sim::Simulation simulation(options);
  Rig rig;
  rig.T_C_L = simulation.T_B_C().inverse() * simulation.T_B_L();
  Config config;
  if (motion == Motion::Unused) config.corridor.memory_s = 0.0;
  Pipeline pipeline(config, StereoGeometry(simulation.calibration()), rig);
  const std::vector<RangeReading> ranges = simulation.ranges();
  auto next = ranges.begin();
  FlightCounts counts;
  for (std::size_t i = 0; i < simulation.frameTimes().size(); ++i) {
    const StereoFrame frame = simulation.frame(i);
    for (; next != ranges.end() && next->stamp_s <= frame.stamp_s; ++next) pipeline.addRange(*next);
    std::optional<Eigen::Isometry3d> T_W_C;
    if (motion == Motion::Told) T_W_C = simulation.T_W_B(frame.stamp_s) * simulation.T_B_C();
    const State state = pipeline.process(frame, T_W_C).verdict.state;
    const sim::CorridorTruth truth = simulation.truth(i);
    if (std::isfinite(truth.clear_exact_m)) {
      counts.wrong_free += state == State::Free;
    } else if (!std::isfinite(truth.clear_inflated_m)) {
      counts.free += state == State::Free;
      counts.unknown += state == State::Unknown;
      counts.blocked += state == State::Blocked;
    }
  }
  return counts;
}

TEST(PipelineMemory, AnOccupiedCellOfTheOctoMapBlocksTheCorridorByDefault) {
  Pipeline pipeline(Config(), rigGeometry(), Rig());
  ASSERT_EQ(pipeline.process(pairOf({masonryAt(6.0)}, 0), Eigen::Isometry3d::Identity()).verdict.state, State::Free);
  const float near_m = 0.2f;  // nearer than stereo sees
  pipeline.obstacles().tree().updateNode(octomap::point3d(0.0f, 0.0f, near_m), true);
  const Verdict blocked = pipeline.process(pairOf({masonryAt(6.0)}, 1), Eigen::Isometry3d::Identity()).verdict;
  EXPECT_EQ(blocked.state, State::Blocked);
  EXPECT_TRUE(blocked.reasons & kOccupiedCell);
  EXPECT_NEAR(blocked.clear_distance_m, near_m, 0.1);
}

TEST(PipelineMemory, WhateverTheVerdictCallsAPatchIsOccupiedInTheMap) {
  for (const double edge_m : {0.07, 0.3}) {
    for (const double shift_m : {0.0, 0.03, 0.05}) {
      const Eigen::Vector3d at(2.0 + shift_m, shift_m, sim::kHeight_m + shift_m);
      Pipeline pipeline(Config(), rigGeometry(), Rig());
      const Report& report =
          pipeline.process(pairOf({masonryAt(6.0), cubeAt(at, edge_m)}, 0), Eigen::Isometry3d::Identity());
      ASSERT_EQ(report.verdict.state, State::Blocked) << edge_m << " m";
      const OccupiedCell cell = nearestOccupied(pipeline.obstacles().tree(), pipeline.boxInCamera());
      // From the cell of its nearest point, which noise may put into the one before.
      EXPECT_LE(cell.clear_distance_m, report.verdict.clear_distance_m) << edge_m << " m, " << shift_m;
      EXPECT_GE(cell.clear_distance_m, report.verdict.clear_distance_m - 2.0 * MapConfig().resolution_m)
          << edge_m << " m, " << shift_m;
    }
  }
}

TEST(PipelineMemory, AnObstacleThatCameTooNearToBeMatchedStillBlocks) {
  EXPECT_EQ(flyWith("close_pole", Motion::Told).wrong_free, 0);
  EXPECT_EQ(flyWith("close_pole", Motion::ByImages).wrong_free, 0);
}

TEST(PipelineMemory, AnObstacleThatWasTakenAwayIsForgotten) {
  Pipeline pipeline(Config(), rigGeometry(), Rig());
  const auto with_cube = [](int i) { return pairOf({masonryAt(6.0), cubeAt({2.0, 0.1, sim::kHeight_m}, 0.3)}, i); };
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(pipeline.process(with_cube(i), Eigen::Isometry3d::Identity()).verdict.state, State::Blocked);
  }
  State state = State::Unknown;
  for (int i = 3; i < 8; ++i) {
    state = pipeline.process(pairOf({masonryAt(6.0)}, i), Eigen::Isometry3d::Identity()).verdict.state;
  }
  EXPECT_EQ(state, State::Free);
}

TEST(PipelineMemory, PlainSurroundingsAreFreeOnceTwoPairsSawThemClear) {
  const FlightCounts alone = flyWith("bare_on_bare", Motion::Unused), told = flyWith("bare_on_bare", Motion::Told);
  EXPECT_EQ(told.wrong_free, 0);
  EXPECT_EQ(told.blocked, alone.blocked);
  EXPECT_GE(told.free, alone.free + (alone.unknown + 1) / 2) << "of " << alone.unknown << " UNKNOWN without memory";
}

TEST(PipelineMemory, WithoutKnownMotionThatIsSaid) {
  Pipeline pipeline(Config(), rigGeometry(), Rig());
  const std::vector<sim::Primitive> plain{sim::backdrop(6.0, sim::plain(0.5))};
  pipeline.process(pairOf(plain, 0));
  EXPECT_TRUE(pipeline.process(pairOf(plain, 1)).verdict.reasons & kNoMotion);
  EXPECT_FALSE(pipeline.process(pairOf(plain, 2), Eigen::Isometry3d::Identity()).verdict.reasons & kNoMotion);
}

TEST(PipelineMemory, NothingIsRememberedAcrossAJumpOfThePose) {
  Pipeline pipeline(Config(), rigGeometry(), Rig());
  pipeline.process(pairOf({masonryAt(6.0), cubeAt({2.0, 0.1, sim::kHeight_m}, 0.3)}, 0), Eigen::Isometry3d::Identity());
  ASSERT_GT(pipeline.obstacles().tree().size(), 0u);
  Eigen::Isometry3d elsewhere = Eigen::Isometry3d::Identity();
  elsewhere.translation().x() = 50.0;
  pipeline.process(pairOf({masonryAt(6.0)}, 1), elsewhere);
  EXPECT_EQ(pipeline.obstacles().tree().size(), 0u);
}

}  // namespace
}  // namespace flight_corridor
