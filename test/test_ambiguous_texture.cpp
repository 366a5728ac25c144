#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <opencv2/core.hpp>
#include <utility>

#include "flight_corridor/ambiguous_texture.hpp"
#include "flight_corridor/corridor.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

const StereoGeometry kGeometry(test_support::vgaCalibration());
constexpr double kNearest_m = 0.5;
const int kWall_px = static_cast<int>(std::lround(kGeometry.disparity(7.0)));
const int kInTheBox_px = static_cast<int>(std::lround(kGeometry.disparity(2.5)));

/// A wall of random columns which are the same again after a period. Noise that does not repeat is added.
StereoFrame stripedWall(int period_px, double noise = 0.0, int disparity_px = kWall_px) {
  const cv::Size size = kGeometry.size();
  const int shift_px = std::abs(disparity_px);
  cv::Mat period(1, period_px, CV_8UC1), row, wall, specks(size.height, size.width + shift_px, CV_8UC1);
  cv::RNG(7).fill(period, cv::RNG::UNIFORM, 0, 200);
  cv::repeat(period, 1, (size.width + shift_px) / period_px + 1, row);
  cv::repeat(row.colRange(0, size.width + shift_px), size.height, 1, wall);
  cv::RNG(8).fill(specks, cv::RNG::UNIFORM, 0, 55);
  cv::addWeighted(wall, 1.0, specks, noise, 0.0, wall);
  StereoFrame pair;
  pair.left = wall.colRange(0, size.width).clone();
  pair.right = wall.colRange(shift_px, shift_px + size.width).clone();
  if (disparity_px < 0) std::swap(pair.left, pair.right);
  return pair;
}

cv::Mat depthOf(int disparity_px) { return {kGeometry.size(), CV_32FC1, cv::Scalar(kGeometry.depth(disparity_px))}; }

bool isAmbiguous(const StereoFrame& pair, const cv::Mat& depth_m) {
  const Box corridor = Corridor(CorridorConfig()).box(opticalFromForward());
  return hasAmbiguousTexture(corridor, pair, depth_m, kNearest_m, kGeometry);
}

TEST(AmbiguousTexture, APatternThatRepeatsItselfMayBeInTheBox) {
  const int difference_px = kInTheBox_px - kWall_px;
  EXPECT_TRUE(isAmbiguous(stripedWall(difference_px), depthOf(kWall_px)));
  EXPECT_TRUE(isAmbiguous(stripedWall(difference_px, 0.1), depthOf(kWall_px))) << "a little noise";
}

TEST(AmbiguousTexture, NoiseThatDoesNotRepeatTellsItsPlace) {
  EXPECT_FALSE(isAmbiguous(stripedWall(kInTheBox_px - kWall_px, 3.0), depthOf(kWall_px)));
}

TEST(AmbiguousTexture, APatternThatRepeatsItselfNearerThanIsSearchedTellsItsPlace) {
  const int beyond_px = static_cast<int>(kGeometry.disparity(kNearest_m)) + 5;
  EXPECT_FALSE(isAmbiguous(stripedWall(beyond_px), depthOf(kWall_px)));
}

TEST(AmbiguousTexture, WhatIsInTheBoxIsNotBehindIt) {
  const StereoFrame pair = stripedWall(kInTheBox_px - kWall_px, 0.0, kInTheBox_px);
  EXPECT_FALSE(isAmbiguous(pair, depthOf(kInTheBox_px)));
  EXPECT_TRUE(isAmbiguous(pair, depthOf(kWall_px))) << "but matched behind it";
}

TEST(AmbiguousTexture, MostOfWhatIsKnownMakesTheViewAmbiguous) {
  const StereoFrame pattern = stripedWall(kInTheBox_px - kWall_px), noise = stripedWall(kGeometry.size().width);
  const int middle = kGeometry.size().width / 2;
  for (const int columns : {middle - 20, middle + 20}) {
    StereoFrame pair = pattern;
    noise.left.colRange(0, columns).copyTo(pair.left.colRange(0, columns));
    noise.right.colRange(0, columns - kWall_px).copyTo(pair.right.colRange(0, columns - kWall_px));
    cv::Mat depth_m = depthOf(kWall_px);
    EXPECT_EQ(isAmbiguous(pair, depth_m), columns < middle);
    depth_m.colRange(0, columns).setTo(std::numeric_limits<float>::quiet_NaN());
    EXPECT_TRUE(isAmbiguous(pair, depth_m)) << "the other part is not known";
  }
  EXPECT_FALSE(isAmbiguous(pattern, depthOf(kWall_px) * std::numeric_limits<float>::quiet_NaN()));
}

TEST(AmbiguousTexture, APatternMatchedALittleBelowZeroDisparityIsTakenToBeFar) {
  EXPECT_TRUE(isAmbiguous(stripedWall(kInTheBox_px + 1, 0.0, -1), depthOf(1) * 16.0));
}

TEST(AmbiguousTexture, TakesADepthThatTheScaleCorrectionMoved) {
  EXPECT_TRUE(isAmbiguous(stripedWall(kInTheBox_px - kWall_px), depthOf(kWall_px) / 0.93));
}

TEST(AmbiguousTexture, KnowsThePrincipalPointsDifference) {
  StereoCalibration calibration = test_support::vgaCalibration();
  const StereoFrame pair = stripedWall(kInTheBox_px - kWall_px);
  calibration.cx_right_px += kWall_px;  // the wall is at infinity
  const Box corridor = Corridor(CorridorConfig()).box(opticalFromForward());
  const cv::Mat far_m(kGeometry.size(), CV_32FC1, cv::Scalar(600.0));
  EXPECT_TRUE(hasAmbiguousTexture(corridor, pair, far_m, kNearest_m, StereoGeometry(calibration)));
}

TEST(AmbiguousTexture, ABlankWallOrABoxOutOfViewIsNot) {
  StereoFrame pair = stripedWall(kInTheBox_px - kWall_px);
  Box behind = Corridor(CorridorConfig()).box(opticalFromForward());
  behind.T_M_F.translation().z() -= 20.0;
  EXPECT_FALSE(hasAmbiguousTexture(behind, pair, depthOf(kWall_px), kNearest_m, kGeometry));
  pair.left.setTo(90);
  pair.right.setTo(90);
  EXPECT_FALSE(isAmbiguous(pair, depthOf(kWall_px)));
}

}  // namespace
}  // namespace flight_corridor
