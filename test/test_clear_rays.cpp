#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "flight_corridor/corridor/clear_rays.hpp"
#include "flight_corridor/stereo/search_range.hpp"
#include "support/calibrations.hpp"
#include "support/evidence.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallGeometry;
using test_support::smallCalibration;
using test_support::texturedAllOver;
using test_support::uniformEvidence;

constexpr int kRow = 100;
constexpr int kColumns = 320;
constexpr double kNoise_px = 0.5;  // more than matches are taken nearer by

class ClearRaysTest : public testing::Test {
 protected:
  void look(const StereoGeometry& geometry = kSmallGeometry) {
    rays_ = ClearRays(geometry);
    lookAtRays();
  }
  void lookAtRays() {
    const ScaleCorrection correction((ScaleConfig()));
    for (int part = 0; part < ClearRays::kParts; ++part) {
      rays_.look(part, evidence_, textured_, right_textured_, correction);
    }
  }

  /// Of the left camera's ray alone, or of the right one's to the same point, too.
  bool isClear(int u, double at_px) const {
    return rays_.isClear(u, kRow, static_cast<float>(at_px), static_cast<int>(std::lround(at_px)));
  }
  bool isLeftClear(int u, double at_px) const {
    return rays_.isClear(u, kRow, static_cast<float>(at_px), kColumns + 1);  // no right pixel
  }

  void match(int first, int end, double disparity_px) { evidence_.best_px.colRange(first, end) = disparity_px; }
  void repeat(int first, int end, double disparity_px, double competitor_px) {
    match(first, end, kNaN);
    evidence_.repeated_px.colRange(first, end) = disparity_px;
    evidence_.flags.colRange(first, end) = kConsistent | kDistinct | kCompetitor | kRepeated;
    evidence_.competitor_nearest.colRange(first, end) = competitor_px - firstDisparity(kSmallGeometry);
  }
  void makeBare(int first, int end) {
    textured_.colRange(first, end) = 0;
    match(first, end, kNaN);
  }

  DisparityEvidence evidence_ = uniformEvidence(kSmallGeometry.size(), 3.0);
  cv::Mat textured_ = texturedAllOver(kSmallGeometry.size());
  cv::Mat right_textured_ = cv::Mat::zeros(kSmallGeometry.size(), CV_8UC1);
  ClearRays rays_{kSmallGeometry};
};

TEST_F(ClearRaysTest, ARayIsClearUpToItsMatch) {
  look();
  for (const int u : {0, 5, 160, 319}) {
    EXPECT_TRUE(isLeftClear(u, 3.0 + kNoise_px)) << u;
    EXPECT_TRUE(isLeftClear(u, 100.0)) << u;
    EXPECT_FALSE(isLeftClear(u, 3.0)) << u;
    EXPECT_FALSE(isLeftClear(u, 2.0)) << u;
  }
}

TEST_F(ClearRaysTest, WhereNothingIsMatchedNothingIsClear) {
  match(0, kColumns, kNaN);
  look();
  for (const int u : {0, 160, 319}) {
    for (const double at_px : {0.5, 3.0, 120.0}) EXPECT_FALSE(isClear(u, at_px)) << u << ", " << at_px << " px";
  }
}

TEST_F(ClearRaysTest, TheRightRayLooksBehindWhatHidesItFromTheLeft) {
  match(150, 170, kNaN);
  look();
  EXPECT_TRUE(isClear(160, 30.0)) << "through right pixel 130, where the wall of left pixel 133 is matched";
  EXPECT_FALSE(isLeftClear(160, 30.0));
  EXPECT_FALSE(isClear(160, 5.0)) << "right pixel 155 is that of left pixel 158";
}

TEST_F(ClearRaysTest, TheRightRayMeetsTheNearestOfWhatIsMatchedThere) {
  match(130, 170, kNaN);
  look();
  EXPECT_TRUE(isClear(145, 25.0)) << "through right pixel 120, that of left pixel 123";
  match(150, 151, 30.0);  // at right pixel 120, too
  look();
  EXPECT_FALSE(isClear(145, 25.0)) << "behind it";
  EXPECT_TRUE(isClear(155, 35.0)) << "before it";
}

TEST_F(ClearRaysTest, ABareRunBetweenTexturedEndsReachesToTheNearerOfThem) {
  makeBare(100, 150);
  match(150, kColumns, 8.0);
  look();
  for (const int u : {100, 125, 149}) {
    EXPECT_TRUE(isLeftClear(u, 8.0 + kNoise_px)) << u;
    EXPECT_FALSE(isLeftClear(u, 7.9)) << u;
  }
}

TEST_F(ClearRaysTest, OfWhatIsKeptForLaterABareRunIsNotClearUnlessTheLidarIsOnIt) {
  makeBare(100, 200);
  makeBare(250, 255);  // a gap of noise
  look();
  ASSERT_TRUE(isLeftClear(150, 4.0));
  rays_.keepSeen();
  EXPECT_FALSE(isLeftClear(150, 100.0));
  EXPECT_TRUE(isLeftClear(50, 4.0)) << "matched";
  EXPECT_TRUE(isLeftClear(252, 4.0)) << "narrow";
  look();
  rays_.clearPlainSurface(evidence_, textured_, ScaleCorrection(ScaleConfig()),
                          kSmallGeometry.point(150, kRow, kSmallGeometry.depth(3.0)));
  rays_.keepSeen();
  EXPECT_TRUE(isLeftClear(150, 4.0));
}

TEST_F(ClearRaysTest, ABareRunAtTheImagesSideStaysUnknown) {
  makeBare(0, 40);
  makeBare(280, kColumns);
  look();
  for (const int u : {0, 20, 39, 280, 300, 319}) EXPECT_FALSE(isLeftClear(u, 100.0)) << u;
  EXPECT_TRUE(isLeftClear(40, 100.0));
}

TEST_F(ClearRaysTest, ABareRunOneOfWhoseEndsIsNotMatchedStaysUnknown) {
  makeBare(100, 150);
  match(150, 170, kNaN);
  look();
  EXPECT_FALSE(isLeftClear(125, 100.0));
  match(150, 152, 3.0);
  look();
  EXPECT_FALSE(isLeftClear(125, 100.0)) << "two pixels may be chance";
}

TEST_F(ClearRaysTest, ABareRunThatTheRightImageShowsElsewhereStaysUnknown) {
  makeBare(100, 150);
  right_textured_.setTo(255);
  right_textured_.colRange(97, 147) = 0;  // where matches of 3 px put it
  look();
  EXPECT_TRUE(isLeftClear(125, 100.0));
  right_textured_.setTo(255);
  right_textured_.colRange(67, 117) = 0;  // as if it were ten times as near
  look();
  EXPECT_FALSE(isLeftClear(125, 100.0));
}

TEST_F(ClearRaysTest, MatchesWithoutTextureAreNoEnds) {
  makeBare(100, 150);
  match(100, 150, 3.0);
  match(150, 170, kNaN);
  look();
  EXPECT_FALSE(isLeftClear(125, 100.0));
}

TEST_F(ClearRaysTest, AMatchWithoutTextureClearsNothing) {
  textured_.setTo(0);
  look();
  for (const int u : {0, 160, 319}) EXPECT_FALSE(isClear(u, 100.0)) << u;
}

TEST_F(ClearRaysTest, ARepeatedMatchClearsUpToItsNearestPlace) {
  for (const double competitor_px : {2.0, 20.0}) {
    repeat(0, kColumns, 10.0, competitor_px);
    look();
    const double nearest_px = std::max(10.0, competitor_px);
    EXPECT_TRUE(isLeftClear(160, nearest_px + kNoise_px));
    EXPECT_FALSE(isLeftClear(160, nearest_px - kNoise_px));
    EXPECT_FALSE(isClear(160, nearest_px - kNoise_px)) << "nor does the right ray";
  }
}

TEST_F(ClearRaysTest, ARepeatedMatchWithoutCompetitorsClearsUpToItself) {
  repeat(0, kColumns, 10.0, 60.0);
  evidence_.flags.setTo(kConsistent | kDistinct);
  look();
  EXPECT_TRUE(isLeftClear(160, 10.0 + kNoise_px)) << "what the maps of competitors hold there says nothing";
  EXPECT_FALSE(isLeftClear(160, 10.0 - kNoise_px));
}

TEST_F(ClearRaysTest, ThePrincipalPointsDifferenceIsPartOfTheShift) {
  StereoCalibration calibration = smallCalibration();
  calibration.cx_right_px -= 7.0;
  match(150, 170, kNaN);
  look(StereoGeometry(calibration));  // left pixel u is at the right camera's u - 10
  EXPECT_TRUE(rays_.isClear(160, kRow, 23.0f, 30));
  EXPECT_FALSE(rays_.isClear(160, kRow, 3.5f, 4)) << "right pixel 156 is that of left pixel 166";
}

TEST_F(ClearRaysTest, WhatIsLookedAtAnewForgetsWhatWasBefore) {
  lookAtRays();
  ASSERT_TRUE(isClear(160, 20.0));
  match(0, kColumns, kNaN);
  lookAtRays();
  EXPECT_FALSE(isClear(160, 20.0));
}

TEST_F(ClearRaysTest, WhatIsMatchedBesideNeverMakesARayClearFarther) {
  cv::RNG random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const double wall_px = random.uniform(2.0, 20.0);
    match(0, kColumns, wall_px);
    const int first = random.uniform(0, 200);
    match(first, first + random.uniform(1, 60), wall_px + random.uniform(1.0, 20.0));  // something before it
    look();
    for (int u = 0; u < kColumns; u += 3) EXPECT_FALSE(isClear(u, wall_px)) << u;
  }
}

/// Where the UAV's own parts cover a run without texture, a surface may end behind them: texture without matches.
TEST_F(ClearRaysTest, ARunThatReachesACoveredPartIsNotClear) {
  makeBare(100, 200);
  look();
  ASSERT_TRUE(isLeftClear(110, 3.0 + kNoise_px));
  textured_.colRange(140, 160) = 255;
  look();
  for (const int u : {110, 139, 150, 160, 190}) EXPECT_FALSE(isLeftClear(u, 100.0)) << u;
}

}  // namespace
}  // namespace flight_corridor
