#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "flight_corridor/motion/earlier_pairs.hpp"
#include "support/calibrations.hpp"
#include "support/camera_pose.hpp"
#include "support/evidence.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallGeometry, test_support::poseAt;

constexpr double kMemory_s = 1.5;
constexpr double kClearTo_m = 5.0;

/// Pairs that fly straight ahead, whose left rays are clear up to a depth.
class EarlierPairsTest : public testing::Test {
 protected:
  void see(double stamp_s, const CameraPose& pose, double clear_to_m = kClearTo_m) {
    cv::Mat left(kSmallGeometry.size(), CV_32FC1, cv::Scalar(kSmallGeometry.disparity(clear_to_m)));
    cv::Mat right(kSmallGeometry.size(), CV_32FC1, cv::Scalar(kInfinity));
    const cv::Mat depth_m(kSmallGeometry.size(), CV_32FC1, cv::Scalar(clear_to_m));
    earlier_.add(stamp_s, pose, depth_m, test_support::texturedAllOver(kSmallGeometry.size()), left, right);
  }
  /// Of a place in the middle of the view.
  bool wasClear(double depth_m) const {
    const StereoCalibration& rig = kSmallGeometry.calibration();
    return earlier_.plane(depth_m).wasClear(static_cast<int>(rig.cx_px), static_cast<int>(rig.cy_px));
  }

  EarlierPairs earlier_{kSmallGeometry};
};

TEST_F(EarlierPairsTest, APlaceThatTwoPairsSawClearWasClear) {
  see(1.0, poseAt(0.0));
  see(1.2, poseAt(0.3));
  earlier_.moveTo(1.4, poseAt(0.6), kMemory_s);
  EXPECT_TRUE(wasClear(1.0));
  EXPECT_TRUE(wasClear(kClearTo_m - 0.6 - 0.1));
  EXPECT_FALSE(wasClear(kClearTo_m - 0.6 + 0.1)) << "beyond what the first of them saw";
}

TEST_F(EarlierPairsTest, OnePairsMistakeIsNotRemembered) {
  see(1.0, poseAt(0.0));
  see(1.2, poseAt(0.3), 0.5);
  earlier_.moveTo(1.4, poseAt(0.6), kMemory_s);
  EXPECT_FALSE(wasClear(1.0));
}

TEST_F(EarlierPairsTest, ThePlaceIsLookedUpWhereItWasThen) {
  see(1.0, poseAt(0.0));
  see(1.2, poseAt(0.0));
  CameraPose aside = poseAt(0.0);
  aside.T_M_C.translation().x() = 20.0;
  earlier_.moveTo(1.4, aside, kMemory_s);
  EXPECT_FALSE(wasClear(1.0)) << "it was out of their view";
  CameraPose turned = poseAt(0.0);
  turned.T_M_C.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
  earlier_.moveTo(1.4, turned, kMemory_s);
  EXPECT_FALSE(wasClear(1.0)) << "it was behind them";
}

TEST_F(EarlierPairsTest, OldPairsAreForgotten) {
  see(1.0, poseAt(0.0));
  see(1.2, poseAt(0.3));
  earlier_.moveTo(1.0 + kMemory_s + 0.1, poseAt(0.6), kMemory_s);
  EXPECT_FALSE(wasClear(1.0));
}

TEST_F(EarlierPairsTest, PairsOfAnotherSeriesAreNotAsked) {
  see(1.0, poseAt(0.0, 1));
  see(1.2, poseAt(0.3, 1));
  earlier_.moveTo(1.4, poseAt(0.6, 2), kMemory_s);
  EXPECT_FALSE(wasClear(1.0));
  earlier_.moveTo(1.4, std::nullopt, kMemory_s);
  EXPECT_FALSE(wasClear(1.0)) << "nobody knows where they were";
}

TEST_F(EarlierPairsTest, AnUncertainPoseIsNotTrusted) {
  see(1.0, poseAt(0.0));
  see(1.2, poseAt(0.3));
  CameraPose now = poseAt(0.6);
  now.translation.own = std::pow(0.02, 2);
  earlier_.moveTo(1.4, now, kMemory_s);
  EXPECT_TRUE(wasClear(1.0));
  now.translation.own = std::pow(0.05, 2);
  earlier_.moveTo(1.4, now, kMemory_s);
  EXPECT_FALSE(wasClear(1.0));
}

TEST_F(EarlierPairsTest, PairsFromOnePlaceAndMomentCountOnce) {
  see(1.00, poseAt(0.0));
  see(1.01, poseAt(0.01));
  earlier_.moveTo(1.4, poseAt(0.6), kMemory_s);
  EXPECT_FALSE(wasClear(1.0));
}

TEST_F(EarlierPairsTest, WhereASurfaceIsSeenNoMoreSomethingMayHaveComeBeforeIt) {
  see(1.0, poseAt(0.0));
  see(1.2, poseAt(0.0));
  earlier_.moveTo(1.4, poseAt(0.0), kMemory_s);
  const auto wall_px = static_cast<float>(kSmallGeometry.disparity(kClearTo_m));
  DisparityEvidence matches = test_support::uniformEvidence(kSmallGeometry.size(), wall_px);
  const cv::Rect covered(100, 80, 40, 40);
  matches.best_px(covered) = kNaN;
  earlier_.look(matches, test_support::texturedAllOver(kSmallGeometry.size()));
  EXPECT_TRUE(earlier_.hasVanished(120, 100));
  EXPECT_FALSE(earlier_.hasVanished(60, 100));
  EXPECT_FALSE(earlier_.hasVanished(180, 100));
}

TEST_F(EarlierPairsTest, WhatWasNeverSeenHasNotVanished) {
  see(1.0, poseAt(0.0), kNaN);
  see(1.2, poseAt(0.0), kNaN);
  earlier_.moveTo(1.4, poseAt(0.0), kMemory_s);
  DisparityEvidence matches = test_support::uniformEvidence(kSmallGeometry.size(), 3.0);
  matches.best_px = kNaN;
  earlier_.look(matches, test_support::texturedAllOver(kSmallGeometry.size()));
  EXPECT_FALSE(earlier_.hasVanished(120, 100));
}

}  // namespace
}  // namespace flight_corridor
