#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight_corridor/geometry/cross_sections.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

const StereoGeometry kGeometry(test_support::vgaCalibration());  // f = 350 px, 640 x 480

Box ahead(double length_m, const Eigen::Vector3d& start_F = Eigen::Vector3d::Zero()) {
  return {opticalFromForward() * Eigen::Translation3d(start_F), {length_m, 1.2, 0.4}};
}

TEST(CrossSections, TheEndIsTheFirst) {
  const std::vector<cv::Rect> views = crossSections(ahead(4.0), kGeometry);
  ASSERT_FALSE(views.empty());
  EXPECT_NEAR(views[0].width, 350.0 * 1.2 / 4.0, 1.0);
  EXPECT_NEAR(views[0].height, 350.0 * 0.4 / 4.0, 1.0);
  EXPECT_NEAR(views[0].x + views[0].width / 2.0, 319.5, 1.0);
  EXPECT_NEAR(views[0].y + views[0].height / 2.0, 239.5, 1.0);
}

TEST(CrossSections, TheyGrowTowardsTheCamera) {
  const std::vector<cv::Rect> views = crossSections(ahead(4.0), kGeometry);
  EXPECT_EQ(views.size(), 12u);  // 4 m * 0.85^11 = 0.67 m
  for (std::size_t i = 1; i < views.size(); ++i) {
    EXPECT_EQ(views[i] & views[i - 1], views[i - 1]) << i;
    EXPECT_EQ(views[i] & cv::Rect({}, kGeometry.size()), views[i]) << i;
  }
  EXPECT_NEAR(views.back().width, 350.0 * 1.2 / (4.0 * std::pow(0.85, 11)), 1.0);
}

TEST(CrossSections, TheViewOfTheEndIsTheFirstInView) {
  EXPECT_EQ(viewOfEnd(ahead(4.0), kGeometry), crossSections(ahead(4.0), kGeometry)[0]);
  EXPECT_TRUE(viewOfEnd(ahead(4.0, {0.0, 20.0, 0.0}), kGeometry).empty());
}

TEST(CrossSections, TheFarPartIsSeenALittleBeforeTheEnd) {
  EXPECT_EQ(viewOfFarPart(ahead(4.0), kGeometry), crossSections(ahead(4.0), kGeometry)[1]);
  EXPECT_EQ(viewOfFarPart(ahead(0.3), kGeometry), crossSections(ahead(0.3), kGeometry)[0]) << "it has no other";
  EXPECT_TRUE(viewOfFarPart(ahead(4.0, {0.0, 20.0, 0.0}), kGeometry).empty());
}

TEST(CrossSections, ABoxThatBeginsAheadIsLookedAtFromItsEndToItsStart) {
  const std::vector<cv::Rect> views = crossSections(ahead(2.0, {1.0, 0.0, 0.0}), kGeometry);
  EXPECT_NEAR(views.front().width, 350.0 * 1.2 / 3.0, 1.0);
  EXPECT_NEAR(views.back().width, 350.0 * 1.2 / 1.0, 1.0);
  for (std::size_t i = 1; i < views.size(); ++i) EXPECT_LE(views[i].width, views[i - 1].width / 0.8) << i;
  EXPECT_EQ(crossSections(ahead(0.3, {2.0, 0.0, 0.0}), kGeometry).size(), 2u) << "however short it is";
}

TEST(CrossSections, ABoxThatPointsAtTheCameraIsLookedAtToo) {
  Box towards = ahead(2.0, {3.0, 0.0, 0.0});
  towards.T_M_F.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));
  const std::vector<cv::Rect> views = crossSections(towards, kGeometry);
  EXPECT_NEAR(views.front().width, 350.0 * 1.2 / 1.0, 1.0);
  EXPECT_NEAR(views.back().width, 350.0 * 1.2 / 3.0, 1.0);
  for (std::size_t i = 1; i < views.size(); ++i) EXPECT_GE(views[i].width, 0.8 * views[i - 1].width) << i;
}

TEST(CrossSections, ABoxThatCrossesTheViewIsLookedAtAllAlong) {
  Box across = ahead(3.0);
  across.T_M_F.translation() = Eigen::Vector3d(-1.5, 0.0, 3.0);
  across.T_M_F.rotate(Eigen::AngleAxisd(-M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  double middle_px = kInfinity;
  for (const cv::Rect& view : crossSections(across, kGeometry)) {
    middle_px = std::min(middle_px, std::abs(view.x + view.width / 2.0 - kGeometry.size().width / 2.0));
  }
  EXPECT_LT(middle_px, 30.0);
}

TEST(CrossSections, AShortBoxHasItsEnd) {
  EXPECT_EQ(crossSections(ahead(0.3), kGeometry).size(), 1u);
  EXPECT_LE(crossSections(ahead(std::numeric_limits<double>::denorm_min()), kGeometry).size(), 1u) << "and ends";
}

TEST(CrossSections, WhatIsOutOfViewIsLeftOut) {
  EXPECT_TRUE(crossSections(ahead(4.0, {0.0, 20.0, 0.0}), kGeometry).empty());
  EXPECT_TRUE(crossSections(ahead(4.0, {-9.0, 0.0, 0.0}), kGeometry).empty()) << "behind";
}

TEST(CrossSections, OneThatReachesBehindTheCameraMayBeAnywhere) {
  Box across = ahead(1.0);  // its axis to the right: cross-sections reach before and behind the camera
  across.T_M_F.linear() = across.T_M_F.linear() * Eigen::AngleAxisd(-M_PI / 2.0, Eigen::Vector3d::UnitZ());
  for (const cv::Rect& view : crossSections(across, kGeometry)) EXPECT_EQ(view, cv::Rect({}, kGeometry.size()));
  EXPECT_FALSE(crossSections(across, kGeometry).empty());
}

}  // namespace
}  // namespace flight_corridor
