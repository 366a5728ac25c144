#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "flight_corridor/corridor/holes.hpp"
#include "support/calibrations.hpp"
#include "support/corridor_box.hpp"
#include "support/evidence.hpp"

namespace flight_corridor {
namespace {

using test_support::kBlind_m;
using test_support::kCorridor;
using test_support::kSmallest_m;
using test_support::kVgaGeometry;
using test_support::texturedAllOver;
using test_support::uniformEvidence;

constexpr int kWall_px = 1;  // at 42 m
constexpr double kNearest_m = 0.33;
constexpr double kMostUnclear = 0.3;

class HolesTest : public testing::Test {
 protected:
  Unobserved find(const Box& box = kCorridor, double nearest_m = kNearest_m) {
    const ScaleCorrection correction((ScaleConfig()));
    ClearRays rays(kVgaGeometry);
    for (int part = 0; part < ClearRays::kParts; ++part) {
      rays.look(part, evidence_, textured_, right_textured_, correction);
    }
    const Absence absence{rays, evidence_, textured_, earlier_};
    return Holes(kVgaGeometry).find(box, absence, correction, kBlind_m, nearest_m, kSmallest_m, kMostUnclear).front();
  }

  /// Something of which nothing is matched hides the wall from both cameras.
  void hide(const cv::Rect& pixels, int disparity_px) {
    evidence_.best_px(pixels) = kNaN;
    evidence_.best_px(pixels - cv::Point(disparity_px - kWall_px, 0)) = kNaN;
  }

  /// Its front at a disparity.
  static cv::Rect square(const cv::Point& middle, double edge_m, int disparity_px) {
    const int edge_px = static_cast<int>(std::ceil(edge_m / kVgaGeometry.pixelEdge(disparity_px)));
    return {middle - cv::Point(edge_px / 2, edge_px / 2), cv::Size(edge_px, edge_px)};
  }

  /// A board without texture, whose edges alone are matched.
  void putBoard(const cv::Rect& pixels, int disparity_px) {
    hide(pixels, disparity_px);
    textured_(pixels) = 0;
    right_textured_(pixels - cv::Point(disparity_px, 0)) = 0;
    for (const int u : {pixels.x - kEdge_px, pixels.br().x}) {
      evidence_.best_px({u, pixels.y, kEdge_px, pixels.height}) = disparity_px;
    }
  }

  static constexpr int kEdge_px = 4;
  const EarlierPairs earlier_{kVgaGeometry};
  DisparityEvidence evidence_ = uniformEvidence(kVgaGeometry.size(), kWall_px);
  cv::Mat textured_ = texturedAllOver(kVgaGeometry.size());
  cv::Mat right_textured_ = texturedAllOver(kVgaGeometry.size());
};

TEST_F(HolesTest, WhereNothingIsMatchedTheHoleIsAsLargeAsTheBoxsSection) {
  evidence_.best_px = kNaN;
  const Unobserved unobserved = find();
  EXPECT_NEAR(unobserved.hole_m, 0.4, 0.4 * kSmallest_m) << "the box's height, less what the strides leave";
  EXPECT_EQ(unobserved.fraction, 1.0);
}

TEST_F(HolesTest, AWallBehindTheBoxLeavesNone) {
  const Unobserved unobserved = find();
  EXPECT_EQ(unobserved.hole_m, 0.0);
  EXPECT_TRUE(std::isnan(unobserved.hole_depth_m));
  EXPECT_EQ(unobserved.fraction, 0.0);
  EXPECT_LT(unobserved.end_out_of_view, 0.05);
}

TEST_F(HolesTest, BehindAWallInTheBoxAllIsOne) {
  const double wall_m = 2.0;
  evidence_ = uniformEvidence(kVgaGeometry.size(), kVgaGeometry.disparity(wall_m));
  const Unobserved unobserved = find();
  EXPECT_NEAR(unobserved.hole_m, 0.4, 0.4 * kSmallest_m);
  EXPECT_GT(unobserved.hole_depth_m, wall_m);
  EXPECT_GT(unobserved.fraction, 0.4);
}

/// From behind the wall on the unclear volume grows, and ever more the nearer the wall is.
TEST_F(HolesTest, UnclearIsFromWhereMoreOfTheBoxThanMayBeIsUnclear) {
  EXPECT_EQ(find().unclear_along_m, kInfinity);
  double before_m = kInfinity;
  for (const double wall_m : {3.8, 3.0, 2.0, 1.0}) {
    evidence_ = uniformEvidence(kVgaGeometry.size(), kVgaGeometry.disparity(wall_m));
    const Unobserved unobserved = find();
    EXPECT_EQ(unobserved.unclear_along_m<kInfinity, unobserved.fraction> kMostUnclear) << wall_m;
    EXPECT_GE(unobserved.unclear_along_m, unobserved.hole_along_m) << wall_m;
    EXPECT_LE(unobserved.unclear_along_m, before_m) << wall_m;
    before_m = unobserved.unclear_along_m;
  }
  EXPECT_LT(before_m, 2.5);
}

/// Nothing of it is seen at its depth; farther away the right camera sees behind it, more than what a pixel there is
/// larger.
TEST_F(HolesTest, ASquareThatIsClearedNowhereIsFoundWhereItIs) {
  for (const int disparity_px : {16, 20, 28}) {
    for (const cv::Point& middle : {cv::Point(320, 240), cv::Point(300, 232)}) {
      evidence_ = uniformEvidence(kVgaGeometry.size(), kWall_px);
      const cv::Rect pixels = square(middle, 2.0 * kSmallest_m, disparity_px);
      hide(pixels, disparity_px);
      const Unobserved unobserved = find();
      const double pixel_m = kVgaGeometry.pixelEdge(disparity_px), depth_m = kVgaGeometry.depth(disparity_px);
      // Between two depths, 6 % from the nearest one, as much of it is seen from beside; and strides are lost.
      const double lost_px = 0.06 * disparity_px + 2.0;
      EXPECT_GT(unobserved.hole_m, std::min(kHole * kSmallest_m - kTouch_m, (pixels.width - lost_px) * pixel_m))
          << disparity_px << " px";
      EXPECT_LT(unobserved.hole_m, 1.06 * (pixels.width + 1.0) * pixel_m) << disparity_px << " px";
      EXPECT_NEAR(unobserved.hole_depth_m, depth_m, 0.12 * depth_m) << disparity_px << " px";
      const cv::Rect around = pixels - cv::Point(2, 2) + cv::Size(4, 4);  // two strides
      EXPECT_EQ(unobserved.hole_px & around, unobserved.hole_px) << pixels;
      EXPECT_LT(unobserved.fraction, 0.1);
    }
  }
}

TEST_F(HolesTest, WhatIsHiddenFromOneCameraAloneIsNone) {
  evidence_.best_px(cv::Rect(300, 225, 20, 30)) = kNaN;
  Unobserved unobserved = find();
  EXPECT_NEAR(unobserved.hole_m, 10.5 * kVgaGeometry.pixelEdge(10.5), 0.02) << "the right camera sees 9.5 of 20 px";
  EXPECT_NEAR(unobserved.hole_depth_m, 4.0, 0.12 * 4.0) << "the nearest depth at which it hides the obstacle";
  evidence_.best_px(cv::Rect(300, 225, 20, 30)) = kWall_px;
  evidence_.best_px(cv::Rect(300, 225, 8, 30)) = kNaN;  // less than the cameras' difference at the end
  EXPECT_EQ(find().hole_m, 0.0);
}

TEST_F(HolesTest, ScatteredPixelsWithoutAMatchAreNone) {
  cv::Mat share(kVgaGeometry.size(), CV_32FC1);
  cv::RNG(3).fill(share, cv::RNG::UNIFORM, 0.0, 1.0);
  evidence_.best_px.setTo(kNaN, share < 0.1);
  const Unobserved unobserved = find();
  EXPECT_EQ(unobserved.hole_m, 0.0);
  EXPECT_FALSE(unobserved.hasHole());
  EXPECT_LT(unobserved.fraction, 0.05);
}

TEST_F(HolesTest, BesideTheBoxNobodyLooks) {
  for (const cv::Rect& beside : {cv::Rect(0, 0, 640, 40), cv::Rect(0, 440, 640, 40)}) {
    evidence_.best_px(beside) = kNaN;
    EXPECT_EQ(find().hole_m, 0.0);
  }
}

TEST_F(HolesTest, ABoxThatIsTurnedAsideIsOutOfView) {
  for (const double yaw_deg : {50.0, -50.0, 90.0, 180.0}) {
    const Eigen::AngleAxisd yaw(yaw_deg * M_PI / 180.0, Eigen::Vector3d::UnitZ());
    const Unobserved unobserved = find({opticalFromForward() * yaw, kCorridor.size_m});
    EXPECT_GT(unobserved.out_of_view, 0.5) << yaw_deg;
    EXPECT_GT(unobserved.end_out_of_view, 0.5) << yaw_deg;
  }
}

TEST_F(HolesTest, NothingNearerThanIsMatchedIsOneButItIsUnobserved) {
  evidence_.best_px = kNaN;
  const double nearest_m = 2.0;
  EXPECT_GT(find(kCorridor, nearest_m).hole_depth_m, nearest_m);
  evidence_ = uniformEvidence(kVgaGeometry.size(), kWall_px);
  const Unobserved unobserved = find(kCorridor, nearest_m);
  EXPECT_EQ(unobserved.hole_m, 0.0);
  const Unobserved far_only = find(kCorridor, 5.0);
  EXPECT_EQ(far_only.hole_m, 0.0);
  EXPECT_EQ(far_only.fraction, 1.0);
  EXPECT_GT(unobserved.fraction, 0.2);
  EXPECT_LT(unobserved.fraction, 0.8);
}

/// Whose ends are matched on the wall.
TEST_F(HolesTest, NoSingleRowThatIsEndedWronglyMakesAHoleLess) {
  constexpr int kBoard_px = 20;
  const cv::Rect board = square({320, 240}, 2.0 * kSmallest_m, kBoard_px);
  putBoard(board, kBoard_px);
  const Unobserved whole = find();
  ASSERT_TRUE(whole.hasHole());
  const cv::Mat best_px = evidence_.best_px.clone();
  for (int v = board.y + 1; v < board.br().y - 1; ++v) {
    best_px.copyTo(evidence_.best_px);
    for (const int u : {board.x - kEdge_px, board.br().x}) evidence_.best_px({u, v, kEdge_px, 1}) = kWall_px;
    const Unobserved found = find();
    EXPECT_EQ(found.hole_m, whole.hole_m) << v;
    EXPECT_EQ(found.hole_along_m, whole.hole_along_m) << v;
  }
}

TEST_F(HolesTest, AMatchLessNeverMakesLessOfThem) {
  cv::RNG random(9);
  double along_m = kInfinity, fraction = 0.0;
  for (int i = 0; i < 40; ++i) {
    const cv::Rect pixels(random.uniform(150, 450), random.uniform(180, 280), random.uniform(5, 40),
                          random.uniform(5, 40));
    evidence_.best_px(pixels) = kNaN;
    const Unobserved unobserved = find();
    EXPECT_LE(unobserved.hole_along_m, along_m) << i;
    EXPECT_GE(unobserved.fraction, fraction) << i;
    along_m = unobserved.hole_along_m;
    fraction = unobserved.fraction;
  }
  EXPECT_LT(along_m, 4.0);
}

}  // namespace
}  // namespace flight_corridor
