#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight_corridor/geometry/cross_sections.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

using test_support::kVgaGeometry;

Box boxAhead(double length_m, const Eigen::Vector3d& start_F = Eigen::Vector3d::Zero()) {
  return {opticalFromForward() * Eigen::Translation3d(start_F), {length_m, 1.2, 0.4}};
}

TEST(CrossSections, TheEndIsTheFirst) {
  const std::vector<cv::Rect> views = crossSections(boxAhead(4.0), kVgaGeometry);
  ASSERT_FALSE(views.empty());
  EXPECT_NEAR(views[0].width, 350.0 * 1.2 / 4.0, 1.0);
  EXPECT_NEAR(views[0].height, 350.0 * 0.4 / 4.0, 1.0);
  EXPECT_NEAR(views[0].x + views[0].width / 2.0, 319.5, 1.0);
  EXPECT_NEAR(views[0].y + views[0].height / 2.0, 239.5, 1.0);
}

TEST(CrossSections, TheyGrowTowardsTheCamera) {
  const std::vector<cv::Rect> views = crossSections(boxAhead(4.0), kVgaGeometry);
  EXPECT_EQ(views.size(), 12u);  // 4 m * 0.85^11 = 0.67 m
  for (std::size_t i = 1; i < views.size(); ++i) {
    EXPECT_EQ(views[i] & views[i - 1], views[i - 1]) << i;
    EXPECT_EQ(views[i] & cv::Rect({}, kVgaGeometry.size()), views[i]) << i;
  }
  EXPECT_NEAR(views.back().width, 350.0 * 1.2 / (4.0 * std::pow(0.85, 11)), 1.0);
}

TEST(CrossSections, TheViewOfTheEndIsTheFirstInView) {
  EXPECT_EQ(viewOfEnd(boxAhead(4.0), kVgaGeometry), crossSections(boxAhead(4.0), kVgaGeometry)[0]);
  EXPECT_TRUE(viewOfEnd(boxAhead(4.0, {0.0, 20.0, 0.0}), kVgaGeometry).empty());
}

TEST(CrossSections, TheFarPartIsSeenALittleBeforeTheEnd) {
  EXPECT_EQ(viewOfFarPart(boxAhead(4.0), kVgaGeometry), crossSections(boxAhead(4.0), kVgaGeometry)[1]);
  EXPECT_EQ(viewOfFarPart(boxAhead(0.3), kVgaGeometry), crossSections(boxAhead(0.3), kVgaGeometry)[0])
      << "it has no other";
  EXPECT_TRUE(viewOfFarPart(boxAhead(4.0, {0.0, 20.0, 0.0}), kVgaGeometry).empty());
}

TEST(CrossSections, ABoxThatBeginsAheadIsLookedAtFromItsEndToItsStart) {
  const std::vector<cv::Rect> views = crossSections(boxAhead(2.0, {1.0, 0.0, 0.0}), kVgaGeometry);
  EXPECT_NEAR(views.front().width, 350.0 * 1.2 / 3.0, 1.0);
  EXPECT_NEAR(views.back().width, 350.0 * 1.2 / 1.0, 1.0);
  for (std::size_t i = 1; i < views.size(); ++i) EXPECT_LE(views[i].width, views[i - 1].width / 0.8) << i;
  EXPECT_EQ(crossSections(boxAhead(0.3, {2.0, 0.0, 0.0}), kVgaGeometry).size(), 2u) << "however short it is";
}

TEST(CrossSections, ABoxThatPointsAtTheCameraIsLookedAtToo) {
  Box towards = boxAhead(2.0, {3.0, 0.0, 0.0});
  towards.T_M_F.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));
  const std::vector<cv::Rect> views = crossSections(towards, kVgaGeometry);
  EXPECT_NEAR(views.front().width, 350.0 * 1.2 / 1.0, 1.0);
  EXPECT_NEAR(views.back().width, 350.0 * 1.2 / 3.0, 1.0);
  for (std::size_t i = 1; i < views.size(); ++i) EXPECT_GE(views[i].width, 0.8 * views[i - 1].width) << i;
}

TEST(CrossSections, ABoxThatCrossesTheViewIsLookedAtAllAlong) {
  Box across = boxAhead(3.0);
  across.T_M_F.translation() = Eigen::Vector3d(-1.5, 0.0, 3.0);
  across.T_M_F.rotate(Eigen::AngleAxisd(-M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  double middle_px = kInfinity;
  for (const cv::Rect& view : crossSections(across, kVgaGeometry)) {
    middle_px = std::min(middle_px, std::abs(view.x + view.width / 2.0 - kVgaGeometry.size().width / 2.0));
  }
  EXPECT_LT(middle_px, 30.0);
}

TEST(CrossSections, AShortBoxHasItsEnd) {
  EXPECT_EQ(crossSections(boxAhead(0.3), kVgaGeometry).size(), 1u);
  EXPECT_LE(crossSections(boxAhead(std::numeric_limits<double>::denorm_min()), kVgaGeometry).size(), 1u) << "and ends";
}

TEST(CrossSections, WhatIsOutOfViewIsLeftOut) {
  EXPECT_TRUE(crossSections(boxAhead(4.0, {0.0, 20.0, 0.0}), kVgaGeometry).empty());
  EXPECT_TRUE(crossSections(boxAhead(4.0, {-9.0, 0.0, 0.0}), kVgaGeometry).empty()) << "behind";
}

TEST(CrossSections, OneThatReachesBehindTheCameraMayBeAnywhere) {
  Box across = boxAhead(1.0);  // its axis to the right: cross-sections reach before and behind the camera
  across.T_M_F.linear() = across.T_M_F.linear() * Eigen::AngleAxisd(-M_PI / 2.0, Eigen::Vector3d::UnitZ());
  for (const cv::Rect& view : crossSections(across, kVgaGeometry)) EXPECT_EQ(view, cv::Rect({}, kVgaGeometry.size()));
  EXPECT_FALSE(crossSections(across, kVgaGeometry).empty());
}

}  // namespace
}  // namespace flight_corridor
