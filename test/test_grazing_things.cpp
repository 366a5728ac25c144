#include <gtest/gtest.h>

#include <cmath>

#include "flight_corridor/corridor.hpp"
#include "flight_corridor/cross_sections.hpp"
#include "flight_corridor/grazing_things.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

const StereoGeometry kGeometry(test_support::vgaCalibration());  // f = 350 px, 640 x 480
constexpr double kBand_px = 0.12;
const Box kBox = Corridor(CorridorConfig()).box(opticalFromForward());
const cv::Rect kEnd = viewOfEnd(kBox, kGeometry);

/// Depth at which the box's end is told to be by a match that is so much too far.
double endToldTooFar(double error_px) { return kGeometry.shiftedDepth(kBox.size_m.x(), -error_px); }

/// A patch at one depth before a far wall.
bool isGrazedBy(double depth_m, const cv::Rect& patch) {
  cv::Mat view(kGeometry.size(), CV_32FC1, cv::Scalar(9.0));
  view(patch) = depth_m;
  return mayBeGrazed(kBox, view, kGeometry, kBand_px);
}

/// One that reaches so far over the right side of the end's view.
bool isGrazedBy(double depth_m, int inside_px, int height_px = 10) {
  return isGrazedBy(depth_m, {kEnd.br().x - inside_px, kEnd.y + 5, 40, height_px});
}

TEST(GrazingThings, ACornerJustBehindTheEndMayReachIn) {
  EXPECT_TRUE(isGrazedBy(endToldTooFar(0.45), 2));
  EXPECT_FALSE(isGrazedBy(endToldTooFar(0.55), 2));
}

TEST(GrazingThings, ItsEdgeMayBeMatchedAFewPixelsBeside) {
  EXPECT_TRUE(isGrazedBy(endToldTooFar(0.2), -2));
  EXPECT_FALSE(isGrazedBy(endToldTooFar(0.2), -5));
}

TEST(GrazingThings, WhatTheMapTakesToBeInTheBoxIsJudgedThere) {
  EXPECT_TRUE(isGrazedBy(endToldTooFar(1.1 * kBand_px), 2));
  EXPECT_FALSE(isGrazedBy(endToldTooFar(0.9 * kBand_px), 2));
  EXPECT_FALSE(isGrazedBy(3.0, -2)) << "beside the box, before its end";
}

TEST(GrazingThings, AFewPixelsAreChance) {
  EXPECT_FALSE(isGrazedBy(endToldTooFar(0.2), 2, 1));
  EXPECT_TRUE(isGrazedBy(endToldTooFar(0.2), 2, 4));
}

TEST(GrazingThings, AWallCloseBehindTheEndIsWhereItIsMatched) {
  EXPECT_FALSE(isGrazedBy(endToldTooFar(0.45), cv::Rect({}, kGeometry.size())));
  for (const double share : {0.2, 0.3}) {
    const cv::Rect part(kEnd.tl(), cv::Size(static_cast<int>(share * kEnd.width), kEnd.height));
    EXPECT_EQ(isGrazedBy(endToldTooFar(0.45), part), share == 0.2);
  }
}

TEST(GrazingThings, AWallFartherBehindDoesNotHideAThingBeforeIt) {
  for (const double wall_px : {0.7, 0.9}) {
    cv::Mat view(kGeometry.size(), CV_32FC1, cv::Scalar(endToldTooFar(wall_px)));
    view(cv::Rect(kEnd.br().x - 2, kEnd.y + 5, 40, 10)) = endToldTooFar(0.2);
    EXPECT_EQ(mayBeGrazed(kBox, view, kGeometry, kBand_px), wall_px == 0.9);
  }
}

TEST(GrazingThings, TheBoxMayPointAside) {
  Box aside = kBox;
  aside.T_M_F.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  const cv::Rect end = viewOfEnd(aside, kGeometry);
  cv::Mat view(kGeometry.size(), CV_32FC1, cv::Scalar(9.0));
  view(cv::Rect(end.x + end.width / 2 - 5, end.y + end.height / 2 - 5, 10, 10)) =
      kGeometry.shiftedDepth(aside.size_m.x() * std::cos(0.3), -0.3);
  EXPECT_TRUE(mayBeGrazed(aside, view, kGeometry, kBand_px));
  EXPECT_FALSE(mayBeGrazed(kBox, view, kGeometry, kBand_px));
}

TEST(GrazingThings, WithoutAnImageOrAViewOfTheEndThereAreNone) {
  EXPECT_FALSE(mayBeGrazed(kBox, cv::Mat(), kGeometry, kBand_px));
  const cv::Mat near_wall(kGeometry.size(), CV_32FC1, cv::Scalar(endToldTooFar(0.2)));
  const Box behind{kBox.T_M_F * Eigen::Translation3d(-9.0, 0.0, 0.0), kBox.size_m};
  EXPECT_FALSE(mayBeGrazed(behind, near_wall, kGeometry, kBand_px));
}

TEST(GrazingThings, NoDepthIsNowhere) {
  EXPECT_FALSE(mayBeGrazed(kBox, cv::Mat(kGeometry.size(), CV_32FC1, cv::Scalar(kNaN)), kGeometry, kBand_px));
}

}  // namespace
}  // namespace flight_corridor
