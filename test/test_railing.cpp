#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/corridor/railing.hpp"
#include "flight_corridor/geometry/section.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

using test_support::kVgaGeometry;

constexpr double kNearest_m = 0.5;
const int kWallDisparity_px = static_cast<int>(std::lround(kVgaGeometry.disparity(7.0)));
const int kBarsDisparity_px = static_cast<int>(std::lround(kVgaGeometry.disparity(2.5)));

/// A wall of random columns which are the same again after a period.
StereoFrame stripedWall(int period_px) {
  const cv::Size size = kVgaGeometry.size();
  cv::Mat period(1, period_px, CV_8UC1), row, wall;
  cv::RNG(7).fill(period, cv::RNG::UNIFORM, 0, 200);
  cv::repeat(period, 1, (size.width + kWallDisparity_px) / period_px + 1, row);
  cv::repeat(row.colRange(0, size.width + kWallDisparity_px), size.height, 1, wall);
  StereoFrame pair;
  pair.left = wall.colRange(0, size.width).clone();
  pair.right = wall.colRange(kWallDisparity_px, kWallDisparity_px + size.width).clone();
  return pair;
}

cv::Mat depthOf(int disparity_px) {
  return {kVgaGeometry.size(), CV_32FC1, cv::Scalar(kVgaGeometry.depth(disparity_px))};
}

constexpr int kPitch_px = 24, kBar_px = 8;
constexpr int kFencePitch_px = 14;                                                // 0.28 m where the wall is
constexpr std::array<int, kBar_px> kBar{160, 230, 240, 150, 200, 170, 180, 250};  // its columns

/// Bars before a wall of noise, each of which fits on another one at the wall's
/// distance: the right image is the left one, shifted.
StereoFrame barsBeforeWall(const std::vector<int>& bars_px) {
  const cv::Size size = kVgaGeometry.size();
  cv::Mat wall(size.height, size.width + kWallDisparity_px, CV_8UC1);
  cv::RNG(9).fill(wall, cv::RNG::UNIFORM, 0, 100);
  for (const int u : bars_px) {
    for (int i = 0; i < kBar_px; ++i) wall.col(u + i).setTo(kBar.at(i));
  }
  StereoFrame pair;
  pair.left = wall.colRange(0, size.width).clone();
  pair.right = wall.colRange(kWallDisparity_px, wall.cols).clone();
  return pair;
}

StereoFrame railing(int pitch_px = kPitch_px) {
  std::vector<int> bars_px;
  for (int u = 0; u + kBar_px <= kVgaGeometry.size().width; u += pitch_px) bars_px.push_back(u);
  return barsBeforeWall(bars_px);
}

bool isRailing(const StereoFrame& pair, const cv::Mat& depth_m, double lidar_px = kNaN,
               const StereoGeometry& geometry = kVgaGeometry) {
  const Box corridor = corridorBox(CorridorConfig(), opticalFromForward());
  Railings railings(geometry);
  railings.look(corridor, pair, depth_m, kNearest_m);
  return railings.mayBeIn(corridor, lidar_px);
}

TEST(Railing, EqualBarsOnTheWallBehindMayStandInTheBox) {
  EXPECT_TRUE(isRailing(railing(), depthOf(kWallDisparity_px)));
}

TEST(Railing, TheLidarDecidesWhereAllIsOfOnePattern) {
  EXPECT_TRUE(isRailing(railing(), depthOf(kWallDisparity_px), kWallDisparity_px))
      << "its beam may pass between the bars";
  const StereoFrame stripes = stripedWall(kPitch_px);
  EXPECT_TRUE(isRailing(stripes, depthOf(kWallDisparity_px)));
  EXPECT_FALSE(isRailing(stripes, depthOf(kWallDisparity_px), kWallDisparity_px));
  EXPECT_TRUE(isRailing(stripes, depthOf(kWallDisparity_px), kWallDisparity_px - 2)) << "it met what is behind";
}

TEST(Railing, AFenceShowsWhatIsFartherBesideIt) {
  const cv::Rect view = viewOfFarPart(corridorBox(CorridorConfig(), opticalFromForward()), kVgaGeometry);
  for (const auto& [farther_px, rows] : {std::pair(1.2, 0.4), std::pair(1.2, 0.2), std::pair(0.8, 0.4)}) {
    const int first = view.y - static_cast<int>(rows * view.height);
    cv::Mat depth_m = depthOf(kWallDisparity_px);
    depth_m.rowRange(first, view.y).setTo(kVgaGeometry.depth(kWallDisparity_px - farther_px));
    EXPECT_EQ(isRailing(railing(kFencePitch_px), depth_m), farther_px < 1.0 || rows < 0.3)
        << farther_px << " px " << rows;
    EXPECT_TRUE(isRailing(railing(kPitch_px), depth_m)) << "no fence's bars are 0.48 m apart";
  }
}

TEST(Railing, BarsOfWhichNoTwoPairsAreEquallyFarApartTellTheirPlace) {
  std::vector<int> bars_px;
  for (const int mark : {0, 1, 4, 9, 15, 22, 32, 34})
    bars_px.push_back(kVgaGeometry.size().width / 2 - 170 + 10 * mark);
  EXPECT_FALSE(isRailing(barsBeforeWall(bars_px), depthOf(kWallDisparity_px)));
}

TEST(Railing, FewBarsMayBeChance) {
  const int middle = kVgaGeometry.size().width / 2;
  EXPECT_FALSE(isRailing(barsBeforeWall({middle - kPitch_px, middle}), depthOf(kWallDisparity_px)))
      << "few of the windows";
  cv::Mat depth_m(kVgaGeometry.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  for (const auto& [rows, is_railing] : {std::pair(2, false), std::pair(8, true)}) {
    const int first = kVgaGeometry.size().height / 2;
    depth_m(cv::Rect(middle - 30, first, 60, rows)).setTo(kVgaGeometry.depth(kWallDisparity_px));
    EXPECT_EQ(isRailing(railing(), depth_m), is_railing) << "of " << rows << " rows of windows";
  }
}

TEST(Railing, TwoThingsThatLookAlikeStandInNoRow) {
  constexpr int kApart_px = 50, kWidth_px = 40;
  const int first =
      kVgaGeometry.size().width / 2 - 10;  // in the view; one is beside it on the left, the next one is not
  for (const int count : {2, 3}) {
    StereoFrame pair = barsBeforeWall({});
    for (int i = 1; i < count; ++i) {
      for (const auto& [image, u] : {std::pair(&pair.left, first), std::pair(&pair.right, first - kWallDisparity_px)}) {
        const cv::Mat bar = image->colRange(u, u + kWidth_px);
        bar.copyTo(image->colRange(u - i * kApart_px, u - i * kApart_px + kWidth_px));
      }
    }
    EXPECT_EQ(isRailing(pair, depthOf(kWallDisparity_px)), count == 3) << count << " of them";
  }
}

TEST(Railing, WhatIsInTheBoxOrUnknownIsNotOne) {
  EXPECT_FALSE(isRailing(railing(), depthOf(kBarsDisparity_px)));
  EXPECT_FALSE(isRailing(railing(), depthOf(kWallDisparity_px) * std::numeric_limits<float>::quiet_NaN()));
}

TEST(Railing, TakesADepthThatTheScaleCorrectionMoved) {
  for (const double factor : {0.85, 0.95, 1.05, 1.15}) {
    EXPECT_TRUE(isRailing(railing(), depthOf(kWallDisparity_px) * factor)) << factor;
  }
}

TEST(Railing, BarsMayStandAPixelBesideTheirPlace) {
  std::vector<int> bars_px;
  for (int i = 0, u = 0; u + kBar_px <= kVgaGeometry.size().width; u += kPitch_px + i++ % 2) bars_px.push_back(u);
  EXPECT_TRUE(isRailing(barsBeforeWall(bars_px), depthOf(kWallDisparity_px)));
}

TEST(Railing, KnowsThePrincipalPointsDifference) {
  StereoCalibration calibration = test_support::vgaCalibration();
  calibration.cx_right_px -= 3.0;  // the matches' disparities are 3 px too large
  const cv::Mat depth_m(kVgaGeometry.size(), CV_32FC1, cv::Scalar(kVgaGeometry.depth(kWallDisparity_px - 3)));
  EXPECT_TRUE(isRailing(railing(), depth_m, kNaN, StereoGeometry(calibration)));
}

}  // namespace
}  // namespace flight_corridor
