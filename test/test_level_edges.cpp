#include <gtest/gtest.h>

#include "flight_corridor/corridor.hpp"
#include "flight_corridor/level_edges.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

const StereoGeometry kGeometry(test_support::smallCalibration());
constexpr double kBand_px = 0.3;
const Box kBox = Corridor(CorridorConfig()).box(opticalFromForward());

/// A level run of pixels ahead at one depth, all else far away and not level.
bool mayHold(double depth_m, int length_px = 40) {
  cv::Mat depth(kGeometry.size(), CV_32FC1, cv::Scalar(9.0)), level = cv::Mat::zeros(kGeometry.size(), CV_8U);
  const cv::Rect run(kGeometry.size().width / 2, kGeometry.size().height / 2, length_px, 1);
  depth(run) = depth_m;
  level(run) = 255;
  return mayHoldLevelEdge(kBox, depth, level, kGeometry, kBand_px);
}

/// Depth at which the box's end is told to be by a match that is so much too far.
double endToldTooFar(double error_px) { return kGeometry.shiftedDepth(kBox.size_m.x(), -error_px); }

TEST(LevelEdges, OneThatIsMatchedABitBehindTheBoxMayBeInIt) {
  EXPECT_TRUE(mayHold(endToldTooFar(0.9)));
  EXPECT_FALSE(mayHold(endToldTooFar(1.1)));
}

TEST(LevelEdges, WhatTheMapTakesToBeInTheBoxIsJudgedThere) {
  EXPECT_FALSE(mayHold(3.5));
  EXPECT_FALSE(mayHold(endToldTooFar(0.9 * kBand_px)));
  EXPECT_TRUE(mayHold(endToldTooFar(1.1 * kBand_px)));
}

TEST(LevelEdges, AFewPixelsAreChance) { EXPECT_FALSE(mayHold(endToldTooFar(0.9), 11)); }

TEST(LevelEdges, WithoutAnImageThereAreNone) {
  EXPECT_FALSE(mayHoldLevelEdge(kBox, cv::Mat(), cv::Mat(), kGeometry, kBand_px));
}

TEST(LevelEdges, NoDepthIsNowhere) {
  cv::Mat depth(kGeometry.size(), CV_32FC1, cv::Scalar(kNaN)), level(kGeometry.size(), CV_8U, cv::Scalar(255));
  EXPECT_FALSE(mayHoldLevelEdge(kBox, depth, level, kGeometry, kBand_px));
}

}  // namespace
}  // namespace flight_corridor
