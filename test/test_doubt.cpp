#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "flight_corridor/corridor/doubt.hpp"
#include "flight_corridor/stereo/search_range.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"
#include "support/calibrations.hpp"
#include "support/camera_pose.hpp"
#include "support/corridor_box.hpp"
#include "support/evidence.hpp"

namespace flight_corridor {
namespace {

using test_support::kBlind_m;
using test_support::kCorridor;
using test_support::kSmallest_m;
using test_support::kSmallGeometry;

BandWorkers workers(2);

constexpr float kWall_px = 3.0f;  // at 7 m
constexpr int kInTheBox_px = 10;  // at 2.1 m
const cv::Point kMiddle(160, 120);

/// A wall behind the box of which everything is certain.
const EarlierMatches kNoEarlier(kSmallGeometry, 0.3);

DisparityEvidence certainWall() { return test_support::uniformEvidence(kSmallGeometry.size(), kWall_px); }

/// Where a set has a disparity.
int placeOf(int disparity_px) { return disparity_px - static_cast<int>(firstDisparity(kSmallGeometry)); }

/// Pixels whose set holds another disparity, too.
void addToSet(const cv::Rect& pixels, int disparity_px, DisparityEvidence& evidence) {
  for (int v = pixels.y; v < pixels.br().y; ++v) {
    for (int u = pixels.x; u < pixels.br().x; ++u) {
      reinterpret_cast<std::uint64_t*>(evidence.set.ptr(v, u))[placeOf(disparity_px) / 64] |=
          std::uint64_t{1} << placeOf(disparity_px) % 64;
    }
  }
}

bool isIn(const DisparityEvidence& evidence, const ScaleCorrection& correction, double lidar_px, const Box& box,
          double from_m = kBlind_m) {
  Doubt doubt(kSmallGeometry);
  doubt.find(box, from_m, evidence, kNoEarlier, correction, {{true, lidar_px}}, kSmallest_m, workers);
  return doubt.isIn(0);
}

bool isIn(const DisparityEvidence& evidence, double lidar_px = kNaN, const Box& box = kCorridor) {
  return isIn(evidence, ScaleCorrection(ScaleConfig()), lidar_px, box);
}

/// As many pixels side by side as the smallest obstacle covers in the box.
cv::Rect smallest() {
  const double edge_px = kSmallest_m * kSmallGeometry.calibration().fx_px / kSmallGeometry.depth(kInTheBox_px);
  return {kMiddle, cv::Size(static_cast<int>(std::ceil(edge_px * edge_px)), 1)};
}

TEST(Doubt, ACertainWallLeavesNone) { EXPECT_FALSE(isIn(certainWall())); }

TEST(Doubt, APatchThatFitsInTheBoxAsWellIsDoubtASmallerOneIsNot) {
  DisparityEvidence evidence = certainWall();
  cv::Rect patch = smallest();
  addToSet(patch, kInTheBox_px, evidence);
  EXPECT_TRUE(isIn(evidence));
  evidence = certainWall();
  patch.width -= 1;
  addToSet(patch, kInTheBox_px, evidence);
  EXPECT_FALSE(isIn(evidence));
}

TEST(Doubt, WhatNoEarlierPairConfirmsIsNone) {
  const CameraPose pose = test_support::poseAt(0.0);
  for (const bool is_seen_twice : {true, false}) {
    DisparityEvidence evidence = certainWall(), before = certainWall();
    addToSet(smallest(), kInTheBox_px, evidence);
    if (is_seen_twice) addToSet(smallest(), kInTheBox_px, before);
    EarlierMatches earlier(kSmallGeometry, 0.3);
    earlier.add(1.0, pose, before);
    earlier.moveTo(1.2, pose, 1.5);
    Doubt doubt(kSmallGeometry);
    doubt.find(kCorridor, kBlind_m, evidence, earlier, ScaleCorrection(ScaleConfig()), {Doubt::Question()}, kSmallest_m,
               workers);
    EXPECT_EQ(doubt.isIn(0), is_seen_twice);
  }
}

TEST(Doubt, PixelsOfDifferentDisparitiesOrApartAreNoPatch) {
  DisparityEvidence evidence = certainWall();
  const cv::Rect patch = smallest();
  for (int i = 0; i < patch.area(); ++i) {
    addToSet({patch.tl() + cv::Point(i, 0), cv::Size(1, 1)}, kInTheBox_px + i % 4, evidence);
  }
  EXPECT_FALSE(isIn(evidence)) << "a disparity of its own";
  evidence = certainWall();
  for (int i = 0; i < patch.area(); ++i) {
    addToSet({patch.tl() + cv::Point(2 * i, 0), cv::Size(1, 1)}, kInTheBox_px, evidence);
  }
  EXPECT_FALSE(isIn(evidence)) << "every second pixel";
}

/// Pixels matched in the box of which a pattern has other places, too.
void repeat(const cv::Rect& pixels, int farthest_px, DisparityEvidence& evidence) {
  addToSet(pixels, kInTheBox_px, evidence);
  evidence.best_px(pixels).setTo(NAN);
  evidence.repeated_px(pixels).setTo(kInTheBox_px);
  evidence.competitor_farthest(pixels).setTo(placeOf(farthest_px));
  evidence.competitor_nearest(pixels).setTo(placeOf(farthest_px));
  evidence.flags(pixels).setTo(kConsistent | kDistinct | kCompetitor);
}

TEST(Doubt, ARepeatedMatchInTheBoxIsDoubtWhereverTheLidarEnds) {
  for (const double lidar_px : {kNaN, static_cast<double>(kWall_px), static_cast<double>(kInTheBox_px)}) {
    DisparityEvidence evidence = certainWall();
    repeat(smallest(), 4, evidence);
    EXPECT_TRUE(isIn(evidence, lidar_px));
    evidence = certainWall();
    repeat({kMiddle, smallest().size() - cv::Size(1, 0)}, 4, evidence);
    EXPECT_FALSE(isIn(evidence, lidar_px)) << "a smaller patch, which may be behind";
  }
}

TEST(Doubt, RepeatedMatchesAllOfWhosePlacesAreInTheBoxNeedNotTouch) {
  DisparityEvidence evidence = certainWall();
  for (int i = 0; i < smallest().area(); ++i) {
    repeat({kMiddle + cv::Point(2 * i, 0), cv::Size(1, 1)}, kInTheBox_px - 1, evidence);
  }
  EXPECT_TRUE(isIn(evidence));
}

TEST(Doubt, ASlantedLineIsAPatch) {
  DisparityEvidence evidence = certainWall();
  for (int i = 0; i < smallest().area(); ++i) {
    addToSet({kMiddle + cv::Point(i, i / 3), cv::Size(1, 1)}, kInTheBox_px, evidence);
  }
  EXPECT_TRUE(isIn(evidence));
}

TEST(Doubt, WhatFitsBesideOrBehindTheBoxIsNone) {
  DisparityEvidence evidence = certainWall();
  addToSet({10, 10, 30, 30}, kInTheBox_px, evidence);
  addToSet({kMiddle, cv::Size(30, 30)}, 5, evidence);  // at 4.2 m
  EXPECT_FALSE(isIn(evidence));
}

TEST(Doubt, WhatIsMatchedInTheBoxOrNotAtAllIsNone) {
  for (const float best_px : {7.0f, static_cast<float>(NAN)}) {
    DisparityEvidence evidence = certainWall();
    addToSet({kMiddle, cv::Size(8, 8)}, kInTheBox_px, evidence);
    evidence.best_px.setTo(best_px);
    EXPECT_FALSE(isIn(evidence)) << best_px;
  }
}

TEST(Doubt, ARepeatedPatternIsDoubtUnlessTheLidarMeasuredItsSurface) {
  DisparityEvidence evidence = certainWall();
  const cv::Rect patch = smallest();
  evidence.competitor_nearest(patch).setTo(placeOf(kInTheBox_px));
  evidence.competitor_farthest(patch).setTo(placeOf(kInTheBox_px));
  EXPECT_FALSE(isIn(evidence)) << "not flagged";
  evidence.flags(patch).setTo(kConsistent | kDistinct | kCompetitor);
  EXPECT_TRUE(isIn(evidence));
  for (const double away_px : {-2.0, -1.1, -0.9, 0.0, 0.9, 1.1, 2.0}) {
    EXPECT_EQ(isIn(evidence, kWall_px + away_px), std::abs(away_px) > 1.0) << away_px;
  }
}

TEST(Doubt, OfCompetitorsOnBothSidesOfTheBoxOneMayBeInIt) {
  DisparityEvidence evidence = certainWall();
  const cv::Rect patch(kMiddle, cv::Size(20, 8));
  evidence.flags(patch).setTo(kConsistent | kDistinct | kCompetitor);
  evidence.competitor_farthest(patch).setTo(placeOf(1));
  evidence.competitor_nearest(patch).setTo(placeOf(2));
  EXPECT_FALSE(isIn(evidence)) << "both behind";
  evidence.competitor_nearest(patch).setTo(placeOf(110));  // nearer than the blind distance
  EXPECT_TRUE(isIn(evidence));
  EXPECT_TRUE(isIn(evidence, kWall_px - 1.5)) << "the LiDAR met what is behind";
  EXPECT_FALSE(isIn(evidence, kWall_px)) << "the LiDAR met it";
}

TEST(Doubt, TheBoxEndsWhereCorrectedDisparitiesSay) {
  ScaleCorrection correction((ScaleConfig()));
  for (int i = 0; i < 200; ++i) correction.update(0.1 * i, 6.0, 5.4, 0.05, 0.0);
  ASSERT_LT(correction.correct(5.6), 5.2);
  DisparityEvidence evidence = certainWall();
  evidence.best_px.setTo(5.6);  // uncorrected it would be in the box, which ends at 5.25 px
  addToSet({kMiddle, cv::Size(8, 8)}, kInTheBox_px, evidence);
  EXPECT_TRUE(isIn(evidence, correction, kNaN, kCorridor));
  EXPECT_FALSE(isIn(evidence));
}

TEST(Doubt, ABoxFromTheCameraOnIsLookedAtAsWell) {
  DisparityEvidence evidence = certainWall();
  addToSet({kMiddle, cv::Size(8, 8)}, kInTheBox_px, evidence);
  EXPECT_TRUE(isIn(evidence, ScaleCorrection(ScaleConfig()), kNaN, kCorridor, 0.0));
}

TEST(Doubt, OfADirectionThatIsNotAskedNothingIsKnown) {
  DisparityEvidence evidence = certainWall();
  repeat({kMiddle, cv::Size(20, 20)}, kInTheBox_px - 1, evidence);
  Doubt doubt(kSmallGeometry);
  const ScaleCorrection correction((ScaleConfig()));
  doubt.find({kCorridor, {0.0, 0.02}, {0.0}}, kBlind_m, evidence, kNoEarlier, correction, {{true}, {false}},
             kSmallest_m, workers);
  EXPECT_TRUE(doubt.isIn(0));
  EXPECT_FALSE(doubt.isIn(1));
}

TEST(Doubt, OfSeveralBoxesEachIsJudgedAsIfAlone) {
  DisparityEvidence evidence = certainWall();
  const cv::Rect patch = smallest();
  addToSet(patch, kInTheBox_px, evidence);
  const std::vector<double> yaws_rad = {-0.4, -0.2, 0.0, 0.2, 0.4}, pitches_rad = {-0.1, 0.0, 0.1};
  const Fan fan(kCorridor, yaws_rad, pitches_rad);
  const ScaleCorrection correction((ScaleConfig()));
  Doubt doubt(kSmallGeometry);
  for (int run = 0; run < 2; ++run) {  // the first leaves nothing behind
    doubt.find(fan, kBlind_m, evidence, kNoEarlier, correction, std::vector<Doubt::Question>(fan.size()), kSmallest_m,
               workers);
    for (int i = 0; i < fan.size(); ++i) EXPECT_EQ(doubt.isIn(i), isIn(evidence, kNaN, fan.box(i))) << i;
  }
  EXPECT_TRUE(doubt.isIn(7)) << "straight ahead";
  EXPECT_FALSE(doubt.isIn(0));
}

TEST(Doubt, BeforeBoxesThatBeginFartherAwayACompetitorMayStandBehindTheBlindDistance) {
  Box box = kCorridor;
  box.T_M_F.translate(Eigen::Vector3d(1.5, 0.0, 0.0));
  DisparityEvidence evidence = certainWall();
  evidence.best_px.setTo(2.0f);
  const cv::Rect patch(kMiddle, cv::Size(20, 8));
  evidence.flags(patch).setTo(kConsistent | kDistinct | kCompetitor);
  evidence.competitor_farthest(patch).setTo(placeOf(1));
  evidence.competitor_nearest(patch).setTo(placeOf(25));  // 0.84 m
  const Fan fan(box, {-0.02, 0.0, 0.02}, {0.0});
  Doubt doubt(kSmallGeometry);
  doubt.find(fan, kBlind_m, evidence, kNoEarlier, ScaleCorrection(ScaleConfig()), std::vector<Doubt::Question>(3),
             kSmallest_m, workers);
  EXPECT_TRUE(doubt.isIn(1));
  for (int i = 0; i < fan.size(); ++i) EXPECT_EQ(doubt.isIn(i), isIn(evidence, kNaN, fan.box(i))) << i;
}

TEST(Doubt, TheImageShowsWhatIsInDoubt) {
  DisparityEvidence evidence = certainWall();
  addToSet({kMiddle, cv::Size(3, 2)}, kInTheBox_px, evidence);
  Doubt doubt(kSmallGeometry);
  doubt.find(kCorridor, kBlind_m, evidence, kNoEarlier, ScaleCorrection(ScaleConfig()), {Doubt::Question()},
             kSmallest_m, workers);
  EXPECT_EQ(cv::countNonZero(doubt.image()), 6);
  EXPECT_EQ(cv::countNonZero(doubt.image()({kMiddle, cv::Size(3, 2)})), 6);
}

}  // namespace
}  // namespace flight_corridor
