#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "flight_corridor/motion/earlier_matches.hpp"
#include "flight_corridor/stereo/search_range.hpp"
#include "support/calibrations.hpp"
#include "support/camera_pose.hpp"
#include "support/evidence.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallGeometry, test_support::poseAt;

constexpr double kLasting_s = 1.5, kPlace_m = 2.0, kBehind_m = 8.0;

/// Pairs that fly straight ahead towards a wall, and a patch in the middle of the newest one's view.
class EarlierMatchesTest : public testing::Test {
 protected:
  static std::vector<cv::Point> patch() {
    std::vector<cv::Point> pixels;
    for (int i = 0; i < 36; ++i) pixels.emplace_back(kSmallGeometry.size().width / 2 + i % 6, kMiddleRow + i / 6);
    return pixels;
  }
  /// @param share of the pixels on which something fits at a depth, besides the wall.
  void see(double stamp_s, const CameraPose& pose, double fits_m, double share = 1.0) {
    DisparityEvidence matches =
        test_support::uniformEvidence(kSmallGeometry.size(), kSmallGeometry.disparity(kBehind_m));
    matches.repeated_px.setTo(kSmallGeometry.disparity(fits_m));
    for (int v = 0; v < matches.repeated_px.rows; ++v) {
      for (int u = 0; u < matches.repeated_px.cols; ++u) {
        if ((7 * u + 3 * v) % 10 >= 10.0 * share) matches.repeated_px.at<float>(v, u) = kNaN;
      }
    }
    earlier_.add(stamp_s, pose, matches);
  }
  bool isRefuted() const {
    return earlier_.refute(patch(), kSmallGeometry.disparity(kPlace_m), ScaleCorrection(ScaleConfig()));
  }

  static inline const int kMiddleRow = kSmallGeometry.size().height / 2;
  EarlierMatches earlier_{kSmallGeometry, 0.3};
};

TEST_F(EarlierMatchesTest, WhatFitsWhereItWasThenStays) {
  see(1.0, poseAt(0.0), kPlace_m + 0.4);
  earlier_.moveTo(1.2, poseAt(0.4), kLasting_s);
  EXPECT_FALSE(isRefuted());
}

TEST_F(EarlierMatchesTest, WhatFitsBehindWhereItWasThenIsRefuted) {
  see(1.0, poseAt(0.0), kPlace_m + 1.0);
  earlier_.moveTo(1.2, poseAt(0.4), kLasting_s);
  EXPECT_TRUE(isRefuted());
}

TEST_F(EarlierMatchesTest, OnePairThatRefutesIsEnough) {
  see(1.0, poseAt(0.0), kPlace_m + 0.4);
  see(1.2, poseAt(0.2), kBehind_m);
  earlier_.moveTo(1.4, poseAt(0.4), kLasting_s);
  EXPECT_TRUE(isRefuted());
}

TEST_F(EarlierMatchesTest, HalfOfItsPixelsMustFit) {
  for (const double share : {0.7, 0.3}) {
    earlier_.forget();
    see(1.0, poseAt(0.0), kPlace_m, share);
    earlier_.moveTo(1.2, poseAt(0.0), kLasting_s);
    EXPECT_EQ(isRefuted(), share < 0.5) << share;
  }
}

TEST_F(EarlierMatchesTest, TheSetCountsLikeAMatch) {
  const double place_px = kSmallGeometry.disparity(kPlace_m);
  DisparityEvidence matches = test_support::uniformEvidence(kSmallGeometry.size(), kSmallGeometry.disparity(kBehind_m));
  const int bit = static_cast<int>(std::lround(place_px - firstDisparity(kSmallGeometry)));
  for (int v = 0; v < matches.set.rows; ++v) {
    for (int u = 0; u < matches.set.cols; ++u) matches.set.ptr(v, u)[bit / 8] = 1 << bit % 8;
  }
  earlier_.add(1.0, poseAt(0.0), matches);
  earlier_.moveTo(1.2, poseAt(0.0), kLasting_s);
  EXPECT_FALSE(isRefuted());
}

TEST_F(EarlierMatchesTest, WhatWasHiddenOrTooNearIsNotRefuted) {
  see(1.0, poseAt(0.0), 0.5 * kPlace_m);  // something nearer
  earlier_.moveTo(1.2, poseAt(0.0), kLasting_s);
  EXPECT_FALSE(isRefuted());
  earlier_.forget();
  see(1.0, poseAt(kPlace_m - 0.2), kBehind_m);  // nearer than anything is matched
  earlier_.moveTo(1.2, poseAt(0.0), kLasting_s);
  EXPECT_FALSE(isRefuted());
}

TEST_F(EarlierMatchesTest, PairsThatDoNotShowThePlaceRefuteNothing) {
  see(1.0, poseAt(1.5 * kPlace_m), kBehind_m);  // it was behind the camera
  earlier_.moveTo(1.2, poseAt(0.0), kLasting_s);
  EXPECT_FALSE(isRefuted());
  earlier_.forget();
  see(1.0, poseAt(0.0), kBehind_m);
  earlier_.moveTo(1.2, poseAt(0.0, 2), kLasting_s);
  EXPECT_FALSE(isRefuted()) << "of another series";
  earlier_.moveTo(1.0 + kLasting_s + 0.1, poseAt(0.0), kLasting_s);
  EXPECT_FALSE(isRefuted()) << "too old";
}

}  // namespace
}  // namespace flight_corridor
