#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "flight_corridor/corridor/bar_gaps.hpp"
#include "support/calibrations.hpp"
#include "support/corridor_box.hpp"

namespace flight_corridor {
namespace {

using test_support::kCorridor;
using test_support::kSmallest_m;
using test_support::kVgaGeometry;

class BarGapsTest : public testing::Test {
 protected:
  /// Matches of a bar, widened by the matches beside its edges.
  void put(const cv::Rect& pixels, double depth_m) {
    disparity_px_(pixels) = static_cast<float>(kVgaGeometry.disparity(depth_m));
  }
  /// A stem 2 m ahead that is matched above and below.
  void putStem(const cv::Rect& above, const cv::Rect& below, double above_m = 2.0, double below_m = 2.0) {
    put(above, above_m);
    put(below, below_m);
  }
  double freeUpTo(const Box& box_C = kCorridor) {
    gaps_.find(disparity_px_, textured_, ScaleCorrection(ScaleConfig()), kSmallest_m);
    return gaps_.freeUpTo(box_C, kSmallest_m).front();
  }

  cv::Mat disparity_px_ = cv::Mat(kVgaGeometry.size(), CV_32FC1, cv::Scalar(kVgaGeometry.disparity(10.0)));
  cv::Mat textured_ = cv::Mat(kVgaGeometry.size(), CV_8UC1, cv::Scalar(255));
  BarGaps gaps_{kVgaGeometry};
};

TEST_F(BarGapsTest, AStemThatIsMatchedAboveAndBelowGoesOnBetween) {
  EXPECT_EQ(freeUpTo(), kInfinity);
  putStem({310, 0, 14, 150}, {310, 330, 14, 150});
  EXPECT_NEAR(freeUpTo(), 2.0, 0.05);
  disparity_px_(cv::Rect(300, 150, 34, 180)).setTo(kNaN);
  EXPECT_NEAR(freeUpTo(), 2.0, 0.05) << "whether or not something is matched there";
}

TEST_F(BarGapsTest, AStemThatLeansGoesOnInItsDirection) {
  putStem({330, 0, 14, 150}, {280, 330, 14, 150});
  EXPECT_NEAR(freeUpTo(), 2.0, 0.05);
}

TEST_F(BarGapsTest, RowsThatAreMissingDoNotPartAPiece) {
  putStem({310, 0, 14, 150}, {310, 330, 14, 150});
  for (int v = 2; v < 480; v += 3) disparity_px_.row(v).setTo(kNaN);
  EXPECT_NEAR(freeUpTo(), 2.0, 0.05);
}

TEST_F(BarGapsTest, MatchesWithoutTextureAreChance) {
  putStem({310, 0, 14, 150}, {310, 330, 14, 150});
  put({290, 150, 54, 180}, 1.9);
  textured_(cv::Rect(290, 150, 54, 180)).setTo(0);
  EXPECT_NEAR(freeUpTo(), 2.0, 0.05) << "they fill no gap";
  textured_(cv::Rect(310, 330, 14, 150)).setTo(0);
  EXPECT_EQ(freeUpTo(), kInfinity) << "nor do they make a piece";
}

TEST_F(BarGapsTest, TwoStemsOneBehindTheOtherAreNotOne) {
  putStem({310, 0, 14, 150}, {310, 330, 14, 150}, 2.0, 2.5);
  EXPECT_EQ(freeUpTo(), kInfinity);
}

TEST_F(BarGapsTest, TwoStemsSideBySideAreNotOne) {
  putStem({310, 0, 14, 150}, {420, 330, 14, 150});
  EXPECT_EQ(freeUpTo(), kInfinity);
}

TEST_F(BarGapsTest, WhatIsWideOrAnEdgeIsNoBar) {
  putStem({220, 0, 200, 150}, {220, 330, 200, 150});  // a window's lintel and sill
  EXPECT_EQ(freeUpTo(), kInfinity);
  put({0, 0, 320, 480}, 3.0);  // a wall on the left
  putStem({320, 0, 14, 150}, {320, 330, 14, 150}, 2.9, 2.9);
  EXPECT_EQ(freeUpTo(), kInfinity);
}

TEST_F(BarGapsTest, APieceAloneHasNoGap) {
  put({310, 330, 14, 150}, 2.0);
  EXPECT_EQ(freeUpTo(), kInfinity);
}

TEST_F(BarGapsTest, WhereSomethingIsMatchedAsNearThereIsNoGap) {
  putStem({310, 0, 14, 150}, {310, 330, 14, 150});
  put({290, 150, 54, 180}, 1.9);
  EXPECT_EQ(freeUpTo(), kInfinity) << "that is a patch";
}

TEST_F(BarGapsTest, AGapOutsideTheBoxIsNotInIt) {
  putStem({310, 0, 14, 150}, {310, 330, 14, 150});
  Box aside = kCorridor;
  aside.T_M_F.translate(Eigen::Vector3d(0.0, 1.0, 0.0));
  EXPECT_EQ(freeUpTo(aside), kInfinity);
  Box shorter = kCorridor;
  shorter.size_m.x() = 1.5;
  EXPECT_EQ(freeUpTo(shorter), kInfinity);
}

}  // namespace
}  // namespace flight_corridor
