#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <string>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "flight_corridor/stereo/match_error.hpp"
#include "sim/rig.hpp"
#include "sim/still.hpp"
#include "support/calibrations.hpp"
#include "support/masonry.hpp"
#include "support/pipeline_inputs.hpp"
#include "support/wall_scene.hpp"

// What changes a scene, a pair or a box in a known way changes the verdict in a known way.

namespace flight_corridor {
namespace {

using World = std::vector<sim::Primitive>;
using test_support::cubeAt;
using test_support::kSmallGeometry;
using test_support::masonryAt;
using test_support::wallFrame;

const StereoCalibration kRig = sim::defaultRig().calibration;

/// Before a wall behind the corridor, at a distance, to the left of its middle.
World boxAt(double x_m, double y_m, double size_m) {
  return {masonryAt(6.0), cubeAt({x_m + 0.5 * size_m, y_m, sim::kHeight_m}, size_m)};
}

struct Scene {
  std::string name;
  World world;
};
std::vector<Scene> scenes() {
  return {{"a wall behind the end", {masonryAt(6.0)}},
          {"a wall in the box", {masonryAt(3.0)}},
          {"a box in the middle", boxAt(2.5, 0.1, 0.3)},
          {"a box at the side", boxAt(2.5, -0.95, 0.4)}};
}

Verdict judge(const StereoFrame& pair, const CorridorConfig& corridor = {}, const StereoCalibration& rig = kRig) {
  Config config;
  config.corridor = corridor;
  Pipeline pipeline(config, StereoGeometry(rig), Rig());
  return pipeline.process(pair).verdict;
}

/// What the right camera sees in a mirror is a left camera's image.
TEST(PipelineChanges, TheMirrorImageHasTheSameVerdict) {
  StereoCalibration mirrored_rig = kRig;
  mirrored_rig.cx_px = kRig.size_px.width - 1 - kRig.cx_right_px;
  mirrored_rig.cx_right_px = kRig.size_px.width - 1 - kRig.cx_px;
  CorridorConfig mirrored_corridor;
  mirrored_corridor.offset_m.y() = -kRig.baseline_m;  // about the axis of the same camera
  for (const Scene& scene : scenes()) {
    const StereoFrame pair = sim::stillPair(scene.world, 1);
    StereoFrame mirrored;
    mirrored.stamp_s = pair.stamp_s;
    cv::flip(pair.right, mirrored.left, 1);
    cv::flip(pair.left, mirrored.right, 1);
    const Verdict one = judge(pair), other = judge(mirrored, mirrored_corridor, mirrored_rig);
    EXPECT_EQ(one.state, other.state) << scene.name << ": " << describeReasons(other.reasons);
    if (std::isfinite(one.clear_distance_m)) {
      const double sigma_m = StereoGeometry(kRig).depthSigma(one.clear_distance_m, kMatchNoise_px);
      EXPECT_NEAR(one.clear_distance_m, other.clear_distance_m, sigma_m) << scene.name;
    } else {
      EXPECT_EQ(other.clear_distance_m, kInfinity) << scene.name;
    }
  }
}

TEST(PipelineChanges, WhereOnTheMapsGridASceneStandsMakesNoDifference) {
  const double half_cell_m = 0.5 * MapConfig().resolution_m;
  for (const Scene& scene : scenes()) {
    const Verdict here = judge(sim::stillPair(scene.world, 1));
    for (int axis = 0; axis < 3; ++axis) {
      World moved = scene.world;
      for (sim::Primitive& solid : moved) solid.T_W_O.pretranslate(half_cell_m * Eigen::Vector3d::Unit(axis));
      const Verdict there = judge(sim::stillPair(moved, 1));
      EXPECT_EQ(here.state, there.state) << scene.name << axis << ": " << describeReasons(there.reasons);
      if (here.state != State::Blocked) continue;
      const double farther_m = axis == 0 ? half_cell_m : 0.0;
      const double sigma_m = StereoGeometry(kRig).depthSigma(3.0, kMatchNoise_px);
      EXPECT_NEAR(here.clear_distance_m + farther_m, there.clear_distance_m, 2.0 * sigma_m) << scene.name << axis;
    }
  }
}

TEST(PipelineChanges, ALongerBoxNeverImprovesTheVerdict) {
  const auto rank = [](State state) { return state == State::Free ? 2 : state == State::Unknown ? 1 : 0; };
  for (const Scene& scene : scenes()) {
    const StereoFrame pair = sim::stillPair(scene.world, 1);
    int before = 2;
    for (const double length_m : {1.0, 2.4, 2.6, 4.0, 7.0}) {
      CorridorConfig corridor;
      corridor.length_m = length_m;
      const int after = rank(judge(pair, corridor).state);
      EXPECT_LE(after, before) << scene.name << ", " << length_m << " m";
      before = after;
    }
    EXPECT_EQ(before, 0) << scene.name << ": a wall is in the longest one";
  }
}

TEST(PipelineChanges, ANewCorridorIsJudgedAsAFreshPipelineWould) {
  CorridorConfig wide, far;
  wide.width_m = 2.4;
  wide.smallest_obstacle_m = 0.1;
  far.offset_m.x() = 1.0;
  far.length_m = 2.0;
  const StereoGeometry geometry(kRig);
  for (const Scene& scene : scenes()) {
    const StereoFrame pair = sim::stillPair(scene.world, 1);
    for (const CorridorConfig& corridor : {wide, far}) {
      Pipeline pipeline(Config(), geometry, Rig());
      pipeline.process(wallFrame(geometry, 4, 0.1));
      pipeline.setCorridor(corridor);
      const Verdict changed = pipeline.process(pair).verdict, fresh = judge(pair, corridor);
      EXPECT_EQ(changed.reasons, fresh.reasons) << scene.name;
      EXPECT_EQ(changed.clear_distance_m, fresh.clear_distance_m) << scene.name;
      EXPECT_EQ(changed.unknown_fraction, fresh.unknown_fraction) << scene.name;
    }
  }
}

/// A wall that comes nearer and goes, with a LiDAR.
std::vector<Verdict> flight(double later_s) {
  Pipeline pipeline(Config(), kSmallGeometry, test_support::rigWithLidar());
  std::vector<Verdict> verdicts;
  double stamp_s = 1.0;
  for (const int disparity_px : {3, 3, 4, 6, 8, 3, 3, 3}) {
    const double range_m = kSmallGeometry.depth(disparity_px);
    for (const double early_s : {0.0625, 0.03125, 0.0}) {
      pipeline.addRange(test_support::reading(stamp_s + later_s - early_s, range_m));
    }
    StereoFrame pair = wallFrame(kSmallGeometry, disparity_px, stamp_s);
    pair.stamp_s += later_s;
    verdicts.push_back(pipeline.process(pair).verdict);
    stamp_s += 0.125;
  }
  return verdicts;
}

TEST(PipelineChanges, AnotherClockGivesTheSameVerdicts) {
  const double later_s = 1 << 20;  // stamps are exact
  const std::vector<Verdict> now = flight(0.0), later = flight(later_s);
  for (std::size_t i = 0; i < now.size(); ++i) {
    EXPECT_EQ(now[i].reasons, later[i].reasons) << i;
    EXPECT_EQ(now[i].clear_distance_m, later[i].clear_distance_m) << i;
    EXPECT_EQ(now[i].stamp_s + later_s, later[i].stamp_s) << i;
  }
}

TEST(PipelineChanges, OneThreadAndFourAnswerTheSame) {
  const int threads = cv::getNumThreads();
  for (const Scene& scene : scenes()) {
    const StereoFrame pair = sim::stillPair(scene.world, 1);
    cv::setNumThreads(1);
    Pipeline alone({}, StereoGeometry(kRig), Rig());
    cv::setNumThreads(4);
    Pipeline with_others({}, StereoGeometry(kRig), Rig());
    const Verdict one = alone.process(pair).verdict, four = with_others.process(pair).verdict;
    EXPECT_EQ(one.reasons, four.reasons) << scene.name;
    EXPECT_EQ(one.clear_distance_m, four.clear_distance_m) << scene.name;
    EXPECT_EQ(one.unknown_fraction, four.unknown_fraction) << scene.name;
    EXPECT_EQ(cv::norm(alone.disparity().set, with_others.disparity().set, cv::NORM_INF), 0.0) << scene.name;
    const std::vector<FreeArea> areas = alone.freeAreas().areas, others = with_others.freeAreas().areas;
    for (std::size_t i = 0; i < areas.size(); ++i) {
      EXPECT_EQ(areas[i].verdict.reasons, others[i].verdict.reasons) << scene.name << ' ' << i;
    }
  }
  cv::setNumThreads(threads);
}

/// A smear on the surface, not on the lens.
TEST(PipelineChanges, WhatIsBlankedOfAnObstacleNeverMakesTheBoxFree) {
  constexpr double kDistance_m = 2.5, kSize_m = 0.3;
  const StereoGeometry geometry(kRig);
  const StereoFrame pair = sim::stillPair(boxAt(kDistance_m, 0.1, kSize_m), 1);
  const Eigen::Vector2d low = geometry.project({-0.1 - 0.5 * kSize_m, -0.5 * kSize_m, kDistance_m});
  const Eigen::Vector2d high = geometry.project({-0.1 + 0.5 * kSize_m, 0.5 * kSize_m, kDistance_m});
  const cv::Rect whole(cv::Point(static_cast<int>(std::ceil(low.x())), static_cast<int>(std::ceil(low.y()))),
                       cv::Point(static_cast<int>(high.x()) + 1, static_cast<int>(high.y()) + 1));
  const int shift_px =
      static_cast<int>(std::lround(geometry.disparity(kDistance_m) + geometry.principalPointDifference()));
  cv::RNG random(7);
  for (int trial = 0; trial < 12; ++trial) {
    cv::Rect blank = whole;
    if (trial >= 4) {
      blank.width = random.uniform(whole.width / 4, whole.width + 1);
      blank.height = random.uniform(whole.height / 4, whole.height + 1);
      blank.x += random.uniform(0, whole.width - blank.width + 1);
      blank.y += random.uniform(0, whole.height - blank.height + 1);
    }
    const double grey = 40.0 + 50.0 * (trial % 4);
    StereoFrame smeared = pair;
    smeared.left = pair.left.clone();
    smeared.right = pair.right.clone();
    smeared.left(blank).setTo(grey);
    smeared.right(blank - cv::Point(shift_px, 0)).setTo(grey);
    const Verdict verdict = judge(smeared);
    EXPECT_NE(verdict.state, State::Free) << blank << " of " << whole << ", grey " << grey;
  }
}

}  // namespace
}  // namespace flight_corridor
