#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "flight_corridor/view/cloud.hpp"
#include "support/calibrations.hpp"
#include "support/parallel_wires.hpp"
#include "support/pipeline_inputs.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using namespace test_support;

TEST(Pipeline, AWallWithinTheCorridorBlocksIt) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  pipeline.addRange(reading(1.0, 3.0));
  const Report& report = pipeline.process(wallFrame(kSmallGeometry, 7, 1.0));  // 3 m
  EXPECT_EQ(report.verdict.state, State::Blocked);
  EXPECT_TRUE(report.verdict.reasons & kOccupiedCell);
  EXPECT_TRUE(report.verdict.reasons & kShortRange);
  EXPECT_NEAR(report.verdict.clear_distance_m, 3.0, 0.03 * 3.0);  // finer than a cell
  EXPECT_NEAR(report.range.range_m, 3.0, 0.05);
  EXPECT_EQ(report.verdict.stamp_s, 1.0);
}

TEST(Pipeline, AWallBeyondTheCorridorLeavesItFree) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  pipeline.addRange(reading(1.0, 7.0));
  const Report& report = pipeline.process(wallFrame(kSmallGeometry, 3, 1.0));  // 7 m
  EXPECT_EQ(report.verdict.state, State::Free)
      << describeReasons(report.verdict.reasons) << " " << report.verdict.unknown_fraction;
  EXPECT_EQ(report.verdict.clear_distance_m, kInfinity);
}

TEST(Pipeline, ACorridorWhoseEndIsOutOfViewIsNotFree) {
  for (const double yaw_deg : {15.0, -15.0, 50.0, -50.0, 90.0, 180.0}) {
    const Eigen::Isometry3d turned(Eigen::AngleAxisd(yaw_deg * M_PI / 180.0, Eigen::Vector3d::UnitZ()));
    Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
    pipeline.pointAlong(opticalFromForward() * turned);
    const Verdict& verdict = pipeline.process(wallFrame(kSmallGeometry, 3, 1.0)).verdict;
    EXPECT_EQ(verdict.state, std::abs(yaw_deg) < 20.0 ? State::Free : State::Unknown) << yaw_deg;
    EXPECT_EQ((verdict.reasons & kUnobserved) == 0, std::abs(yaw_deg) < 20.0) << yaw_deg;
  }
}

/// Of a wall at both sensors' range, when each is off by a variance.
Report seenWithVariance(double variance_m2, double range_m, int disparity_px) {
  Config config;
  config.fusion.lidar_variance_m2 = config.fusion.stereo_variance_m2 = variance_m2;
  Pipeline pipeline(config, kSmallGeometry, rigWithLidar());
  pipeline.addRange(reading(1.0, range_m));
  return pipeline.process(wallFrame(kSmallGeometry, disparity_px, 1.0));
}

TEST(Pipeline, ARangeThatMayEndInTheCorridorBlocksIt) {
  const Report report = seenWithVariance(0.5, 4.2, 5);
  ASSERT_NEAR(report.range.range_m, 4.2, 0.1);
  EXPECT_EQ(report.verdict.state, State::Blocked);
  EXPECT_EQ(report.verdict.reasons & (kShortRange | kOccupiedCell), kShortRange);
  EXPECT_EQ(report.verdict.clear_distance_m, Config().corridor.length_m);
}

TEST(Pipeline, ARangeInTheCorridorBlocksItHoweverUncertain) {
  const Report report = seenWithVariance(50.0, 3.0, 7);
  ASSERT_GT(report.range.sigma_m, report.range.range_m);
  EXPECT_TRUE(report.verdict.reasons & kShortRange);
}

TEST(Pipeline, AMapThatRemembersCallsNothingFreeThatIsNotSeenNow) {
  Config config;
  config.map.frame_id = "odom";
  Pipeline pipeline(config, kSmallGeometry, rigWithLidar());
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  for (double stamp_s = 1.0; stamp_s < 1.5; stamp_s += 0.1) {
    pipeline.addRange(reading(stamp_s, 7.0));
    pipeline.process(wallFrame(kSmallGeometry, 3, stamp_s), here);
  }
  ASSERT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.5), here).verdict.state, State::Free);
  StereoFrame frame = wallFrame(kSmallGeometry, 3, 1.6);
  for (cv::Mat* image : {&frame.left, &frame.right}) image->colRange(60, 260).setTo(128);  // something without texture
  const Report& report = pipeline.process(frame, here);
  EXPECT_EQ(report.verdict.state, State::Unknown);
  EXPECT_TRUE(report.verdict.reasons & kUnobserved);
}

TEST(Pipeline, ABlankMiddleIsUnobserved) {
  StereoFrame frame = wallFrame(kSmallGeometry, 3, 1.0);
  for (cv::Mat* image : {&frame.left, &frame.right}) image->colRange(80, 250).setTo(128);
  Pipeline pipeline(Config(), kSmallGeometry, Rig());
  const Report& report = pipeline.process(frame);
  EXPECT_GT(pipeline.disparity().matched_fraction, 2.0 * Config().stereo.min_matched_fraction) << "of all";
  EXPECT_EQ(report.verdict.state, State::Unknown);
  EXPECT_TRUE(report.verdict.reasons & kUnobserved);
  EXPECT_TRUE(pipeline.query(ahead(1.0, 2.5)).reasons & kUnobserved);
}

TEST(Pipeline, ParallelWiresThatFitOnEachOtherAreNotFree) {
  const ParallelWires wires;
  ASSERT_NEAR(wires.simulation.truth(ParallelWires::kFrame).clear_exact_m, 1.8, 0.1);
  Pipeline pipeline(Config(), wires.geometry, Rig());
  EXPECT_NE(pipeline.process(wires.frame).verdict.state, State::Free);
}

TEST(Pipeline, BlankImagesAreUnknownAndALidarAloneCanBlock) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  StereoFrame frame;
  frame.stamp_s = 1.0;
  frame.left = frame.right = cv::Mat(kSmallGeometry.size(), CV_8UC1, cv::Scalar(128));
  const Report& blank = pipeline.process(frame);
  EXPECT_EQ(blank.verdict.state, State::Unknown);
  EXPECT_TRUE(blank.verdict.reasons & kNoDisparity);
  EXPECT_TRUE(blank.verdict.reasons & kNoRangeObserved);
  pipeline.addRange(reading(1.04, 2.0));
  pipeline.addRange(reading(1.05, 2.0));
  frame.stamp_s = 1.06;
  EXPECT_EQ(pipeline.process(frame).verdict.state, State::Blocked);
  frame.stamp_s = 2.0;  // the reading is old by now
  EXPECT_EQ(pipeline.process(frame).verdict.state, State::Unknown);
}

TEST(Pipeline, ALidarStuckFarAwayCannotFreeABlockedCorridor) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  for (int i = 0; i < 30; ++i) {
    const double stamp = 1.0 + 0.05 * i;
    pipeline.addRange(reading(stamp, 12.0));
    const Report& report = pipeline.process(wallFrame(kSmallGeometry, 7, stamp));
    EXPECT_EQ(report.verdict.state, State::Blocked) << "frame " << i;
    EXPECT_NEAR(report.scale, 1.0, 1e-9) << "frame " << i;
  }
}

TEST(Pipeline, ALidarThatIsLastinglyNearerThanStereoIsNeverFree) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  State last = State::Unknown;
  for (int i = 0; i < 60; ++i) {  // a baseline that is announced far too long: 4.7 m are measured as 7 m
    const double stamp = 1.0 + 0.01 * i;
    pipeline.addRange(reading(stamp, 4.7 + 0.001 * (i % 2)));
    if (i % 10 == 9) last = pipeline.process(wallFrame(kSmallGeometry, 3, stamp)).verdict.state;
  }
  EXPECT_EQ(last, State::Unknown);
  EXPECT_EQ(pipeline.query(ahead(1.0, 2.5)).reasons, kDisagreement | kLidarNearer);
}

/// It may be a leaf; but it may be a rig that was knocked, and is wrong everywhere.
TEST(Pipeline, ALidarThatIsNearerRefusesEveryDirectionAtOnce) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  int refused = 0;
  for (int i = 0; i < 25; ++i) {  // from 2.3 s on something before the wall at 7 m that stereo does not show
    const double stamp_s = 1.0 + 0.1 * i, met_m = i < 13 ? 7.0 : 4.5;
    for (int k = 0; k < 5; ++k) pipeline.addRange(reading(stamp_s - 0.08 + 0.02 * k, met_m + 0.001 * k));
    const bool is_nearer =
        (pipeline.process(wallFrame(kSmallGeometry, 3, stamp_s)).verdict.reasons & kLidarNearer) != 0;
    refused += is_nearer;
    for (const FreeArea& area : pipeline.freeAreas().areas) {
      EXPECT_EQ((area.verdict.reasons & kLidarNearer) != 0, is_nearer) << i << ", " << area.yaw_rad;
      EXPECT_FALSE(is_nearer && area.verdict.state == State::Free) << i << ", " << area.yaw_rad;
    }
  }
  EXPECT_GE(refused, 9);
  EXPECT_LE(refused, 12);
}

TEST(Pipeline, ALidarThatIsLastinglyFartherThanStereoSaysNothingAgainstTheCloud) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  bool followed = false;           // the LiDAR, until the frame that reports the disagreement
  for (int i = 0; i < 150; ++i) {  // the beam passes what the footprint shows at 7 m
    const double stamp = 1.0 + 0.01 * i;
    pipeline.addRange(reading(stamp, 14.0 + 0.001 * (i % 2)));
    if (i % 25 != 24) continue;
    const Verdict verdict = pipeline.process(wallFrame(kSmallGeometry, 3, stamp)).verdict;
    EXPECT_EQ(verdict.state, State::Free) << stamp;
    followed |= (verdict.reasons & kDisagreement) && !(verdict.reasons & kNoLidar);
  }
  EXPECT_TRUE(followed);
}

/// A wall at 7 m, and upright boards before it, at 3 m: the first column of each and how many.
StereoFrame boardsFrame(const std::vector<std::pair<int, int>>& boards, double stamp_s, int board_px = 7) {
  const int shift_px = board_px + static_cast<int>(kSmallGeometry.principalPointDifference());
  StereoFrame frame = wallFrame(kSmallGeometry, 3, stamp_s);
  const StereoFrame near = wallFrame(kSmallGeometry, board_px, stamp_s + 0.01);
  for (const auto& [left, columns] : boards) {
    const int right = left - shift_px;
    near.left.colRange(left, left + columns).copyTo(frame.left.colRange(left, left + columns));
    near.right.colRange(right, right + columns).copyTo(frame.right.colRange(right, right + columns));
  }
  return frame;
}

TEST(Pipeline, ALidarThatMetAnEdgeThatIsShownBesideTheBeamLeavesTheCorridorFree) {
  constexpr int kBoard_px = 6;  // 3.5 m, well behind the corridor
  Config config;
  config.corridor.length_m = 3.0;
  for (const bool is_shown : {true, false}) {
    Pipeline pipeline(config, kSmallGeometry, rigWithLidar());
    Report report;
    for (int i = 0; i < 60; ++i) {
      const double stamp_s = 1.0 + 0.01 * i;
      pipeline.addRange(reading(stamp_s, kSmallGeometry.depth(kBoard_px) + 0.001 * (i % 2)));
      if (i % 10 != 9) continue;
      report = pipeline.process(is_shown ? boardsFrame({{110, 46}, {163, 60}}, stamp_s, kBoard_px)
                                         : wallFrame(kSmallGeometry, 3, stamp_s));
    }
    ASSERT_TRUE(report.verdict.reasons & kDisagreement) << is_shown;
    EXPECT_EQ(report.verdict.state, is_shown ? State::Free : State::Unknown);
    EXPECT_EQ(report.clears, is_shown);
  }
}

/// When boards that blocked are not there 0.1 s later.
Verdict afterBoards(const std::vector<std::pair<int, int>>& boards) {
  Pipeline pipeline(Config(), kSmallGeometry, Rig());
  EXPECT_EQ(pipeline.process(boardsFrame(boards, 1.0)).verdict.state, State::Blocked);
  const Verdict verdict = pipeline.process(wallFrame(kSmallGeometry, 3, 1.1)).verdict;
  EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.3)).verdict.state, State::Free);
  return verdict;
}

TEST(Pipeline, AfterSomethingThinNothingIsFreeForTheHoldTime) {
  const Verdict held = afterBoards({{160, 5}});
  EXPECT_EQ(held.state, State::Unknown);
  EXPECT_EQ(held.reasons & kRecentlyBlocked, kRecentlyBlocked);
}

TEST(Pipeline, AfterSomethingBroadIsSeenToHaveGoneTheCorridorIsFree) {
  EXPECT_EQ(afterBoards({{140, 40}}).state, State::Free);
}

TEST(Pipeline, ARangeThatEndsBeforeTheBroadThingKeepsTheHoldTime) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  for (const double stamp_s : {0.98, 0.99, 1.0}) pipeline.addRange(reading(stamp_s, 1.5));
  const Verdict blocked = pipeline.process(boardsFrame({{140, 40}}, 1.0)).verdict;
  ASSERT_TRUE(blocked.reasons & kOccupiedCell);
  ASSERT_NEAR(blocked.clear_distance_m, 1.5, 0.1);
  for (const double stamp_s : {1.08, 1.09, 1.1}) pipeline.addRange(reading(stamp_s, 7.0));
  EXPECT_TRUE(pipeline.process(wallFrame(kSmallGeometry, 3, 1.1)).verdict.reasons & kRecentlyBlocked);
}

TEST(Pipeline, AThinThingBesideABroadOneKeepsTheHoldTime) {
  EXPECT_EQ(afterBoards({{130, 30}, {175, 5}}).state, State::Unknown);
}

TEST(Pipeline, SomethingThinIsHeldInEveryDirectionWhereItStood) {
  Pipeline pipeline(Config(), kSmallGeometry, Rig());
  const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
  pipeline.process(boardsFrame({{160, 5}}, 1.0), still);
  ASSERT_EQ(pipeline.freeAreas().areas[32].verdict.state, State::Blocked);
  pipeline.process(wallFrame(kSmallGeometry, 3, 1.1), still);
  const AreaGrid areas = pipeline.freeAreas();
  const Verdict asked = pipeline.query(pipeline.box());
  for (const Verdict* held : {&areas.areas[31].verdict, &areas.areas[32].verdict, &asked}) {
    EXPECT_EQ(held->state, State::Unknown);
    EXPECT_TRUE(held->reasons & kRecentlyBlocked);
    EXPECT_GT(held->free_distance_m, 1.0) << "up to where it stood";
    EXPECT_LT(held->free_distance_m, 4.0);
  }
  EXPECT_FALSE(areas.areas[26].verdict.reasons & kRecentlyBlocked) << "30 degrees aside";
}

TEST(Pipeline, AStemBetweenItsPiecesIsNotFree) {
  Pipeline pipeline(Config(), kSmallGeometry, Rig());
  ASSERT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.0)).verdict.state, State::Free);
  StereoFrame stem = boardsFrame({{150, 20}}, 1.1);
  const StereoFrame wall = wallFrame(kSmallGeometry, 3, 1.1);
  for (const auto& [from, to] : {std::pair(wall.left, stem.left), std::pair(wall.right, stem.right)}) {
    from.rowRange(85, 155).copyTo(to.rowRange(85, 155));  // more than the corridor's height there
  }
  const Verdict verdict = pipeline.process(stem).verdict;
  EXPECT_EQ(verdict.state, State::Unknown) << describeReasons(verdict.reasons);
  EXPECT_TRUE(verdict.reasons & kUnobserved);
  EXPECT_NEAR(verdict.free_distance_m, 3.0, 0.2);
  EXPECT_NE(pipeline.freeAreas().areas[32].verdict.state, State::Free);
}

TEST(Pipeline, AfterTheLidarAloneBlockedNothingIsFreeForTheHoldTime) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  for (const double stamp_s : {0.98, 0.99, 1.0}) pipeline.addRange(reading(stamp_s, 3.0));
  EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.0)).verdict.state, State::Blocked);
  for (const double stamp_s : {1.08, 1.09, 1.1}) pipeline.addRange(reading(stamp_s, 7.0));
  EXPECT_TRUE(pipeline.process(wallFrame(kSmallGeometry, 3, 1.1)).verdict.reasons & kRecentlyBlocked);
}

TEST(Pipeline, MovingMapAndPoseTogetherKeepsTheVerdict) {
  Config config;
  config.map.frame_id = "odom";
  Eigen::Isometry3d T_W_C = Eigen::Isometry3d::Identity();
  T_W_C.translation() = Eigen::Vector3d(12.3, -4.56, 7.89);
  T_W_C.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  for (const auto& [disparity_px, state] : {std::pair(3, State::Free), std::pair(7, State::Blocked)}) {
    Pipeline pipeline(config, kSmallGeometry, rigWithLidar()), camera(Config(), kSmallGeometry, rigWithLidar());
    EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, disparity_px, 1.0), T_W_C).verdict.state, state)
        << disparity_px;
    EXPECT_EQ(camera.process(wallFrame(kSmallGeometry, disparity_px, 1.0)).verdict.state, state) << disparity_px;
  }
}

double medianDepth(const Cloud& cloud) {
  std::vector<float> depths;
  for (const auto& point : cloud) depths.push_back(point.z);
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  return depths[depths.size() / 2];
}

TEST(Pipeline, TheCloudIsOfTheLastFrame) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  EXPECT_TRUE(toCloud(pipeline).empty());
  pipeline.process(wallFrame(kSmallGeometry, 7, 1.0));
  ASSERT_FALSE(toCloud(pipeline).empty());
  EXPECT_NEAR(medianDepth(toCloud(pipeline)), 3.0, 0.1);
  pipeline.process(wallFrame(kSmallGeometry, 3, 1.1));
  EXPECT_NEAR(medianDepth(toCloud(pipeline)), 7.0, 0.2);
}

}  // namespace
}  // namespace flight_corridor
