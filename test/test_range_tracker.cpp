#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <stdexcept>

#include "flight_corridor/range/range_tracker.hpp"
#include "support/calibrations.hpp"
#include "support/pipeline_inputs.hpp"

namespace flight_corridor {
namespace {

using namespace test_support;

/// A surface across the view.
cv::Mat showing(double disparity_px) { return cv::Mat(kSmallGeometry.size(), CV_32FC1, cv::Scalar(disparity_px)); }

RangeTracker trackerWithLidar() { return {{}, {}, {}, kSmallGeometry, rigWithLidar().T_C_L}; }

/// Half a second of both sensors; a LiDAR that repeats itself does so to the last bit.
TrackedRange trackedFor(RangeTracker& tracker, double lidar_m, const cv::Mat& disparity_px, bool repeats = false) {
  TrackedRange tracked;
  for (int i = 0; i < 50; ++i) {
    const double stamp_s = 1.0 + 0.01 * i;
    tracker.addRange(reading(stamp_s, lidar_m + (repeats ? 0.0 : 0.001 * (i % 2))));
    if (i % 5 == 4) tracked = tracker.update(stamp_s, disparity_px);
  }
  return tracked;
}

TEST(RangeTracker, BothSensorsTellOneRange) {
  RangeTracker tracker = trackerWithLidar();
  const TrackedRange tracked = trackedFor(tracker, 3.0, showing(7.0));
  EXPECT_NEAR(tracked.range.range_m, 3.0, 0.01);
  EXPECT_NEAR(tracked.range_lidar_m, 3.0, 0.002);
  EXPECT_NEAR(tracked.range_stereo_m, 3.0, 1e-6);
  EXPECT_EQ(tracked.stereo_outcome, Outcome::Accepted);
  EXPECT_EQ(tracked.scale, 1.0);
  EXPECT_EQ(reasonsOf(tracked), 0u);
}

TEST(RangeTracker, WithoutALidarStereoAnswersAlone) {
  RangeTracker tracker({}, {}, {}, kSmallGeometry, std::nullopt);
  tracker.update(1.0, showing(7.0));
  const TrackedRange tracked = tracker.update(1.05, showing(7.0));
  EXPECT_NEAR(tracked.range.range_m, 3.0, 1e-6);
  EXPECT_TRUE(std::isnan(tracked.range_lidar_m));
  EXPECT_FALSE(tracked.lidar_range_valid);
  EXPECT_EQ(reasonsOf(tracked), kNoLidar);
}

TEST(RangeTracker, AReadingOfALidarWhosePlaceIsUnknownIsNotUsed) {
  RangeTracker tracker({}, {}, {}, kSmallGeometry, std::nullopt);
  tracker.addRange(reading(1.0, 3.0));
  const TrackedRange tracked = tracker.update(1.0, showing(kNaN));
  EXPECT_EQ(reasonsOf(tracked), kNoLidar | kLidarRejected | kNoRangeObserved);
  EXPECT_EQ(tracked.stereo_outcome, Outcome::Invalid);
}

TEST(RangeTracker, ReadingsWithAnImpossibleStampTouchNothing) {
  RangeTracker tracker = trackerWithLidar(), clean = trackerWithLidar();
  TrackedRange tracked, expected;
  for (int i = 0; i < 100; ++i) {  // the LiDAR ends on glass at 3 m: a disagreement that must not be forgotten
    const double stamp_s = 100.0 + 0.01 * i, range_m = 3.0 + 0.001 * (i % 2);
    const double wrong_s[] = {0.0, -1e9, 1e9, stamp_s - 60.0, stamp_s + 3600.0, kNaN, kInfinity, 37.0 + 0.01 * i};
    const bool is_wrong = i % 5 == 3;
    tracker.addRange(reading(is_wrong ? wrong_s[i / 5 % 8] : stamp_s, range_m));
    tracker.addAcceleration(is_wrong ? wrong_s[i / 5 % 8] : stamp_s, Eigen::Vector3d::Zero());
    if (!is_wrong) {
      clean.addRange(reading(stamp_s, range_m));
      clean.addAcceleration(stamp_s, Eigen::Vector3d::Zero());
    }
    if (i % 5 != 4) continue;
    tracked = tracker.update(stamp_s, showing(3.0));
    expected = clean.update(stamp_s, showing(3.0));
    EXPECT_EQ(tracked.range.range_m, expected.range.range_m) << i;
    EXPECT_EQ(reasonsOf(tracked), reasonsOf(expected)) << i;
    EXPECT_EQ(tracked.lidar_is_nearer, expected.lidar_is_nearer) << i;
  }
  EXPECT_TRUE(tracked.lidar_is_nearer);
  EXPECT_EQ(tracker.counts().refused, 2u * 19u) << "all but the first pair's, whose time nobody knew before";
}

TEST(RangeTracker, AMountingThatIsSetAnewCounts) {
  RangeTracker tracker = trackerWithLidar();
  const Eigen::Isometry3d moved = Eigen::Translation3d(0.0, 0.0, 0.5) * opticalFromForward();
  EXPECT_NEAR(trackedFor(tracker, 3.0, showing(7.0)).range_stereo_m, 3.0, 1e-6);
  tracker.mount(moved);
  EXPECT_NEAR(tracker.update(1.5, showing(7.0)).range_stereo_m, 2.5, 1e-6);
  EXPECT_THROW(tracker.mount(Eigen::Isometry3d::Identity()), std::invalid_argument) << "looks to the right";
}

TEST(RangeTracker, WhatALidarMetThatIsGoneIsForgottenAtOnce) {
  RangeTracker tracker = trackerWithLidar();
  ASSERT_TRUE(trackedFor(tracker, 7.0, showing(3.0)).lidar_range_valid);
  tracker.mount(std::nullopt);
  const TrackedRange tracked = tracker.update(1.5, showing(7.0));
  EXPECT_FALSE(tracked.lidar_range_valid);
  EXPECT_TRUE(std::isnan(tracked.range_lidar_m));
  EXPECT_FALSE(tracked.range.range_m > 3.1) << "the old beam's 7 m";
}

TEST(RangeTracker, AMountingThatMovesForgetsNoDisagreement) {
  RangeTracker tracker = trackerWithLidar();
  ASSERT_TRUE(trackedFor(tracker, 3.0, showing(3.0)).lidar_is_nearer) << "glass at 3 m, a wall at 7 m";
  for (int i = 0; i < 4; ++i) {
    tracker.mount(opticalFromForward() * Eigen::AngleAxisd(i % 2 == 0 ? 0.05 : -0.05, Eigen::Vector3d::UnitZ()));
    tracker.addRange(reading(1.5 + 0.02 * i, 3.0 + 0.001 * (i % 2)));
    EXPECT_TRUE(tracker.update(1.5 + 0.02 * i, showing(3.0)).lidar_is_nearer);
  }
}

TEST(RangeTracker, AMatchThatDiffersFromTheLidarTeachesTheScale) {
  RangeTracker tracker = trackerWithLidar();
  EXPECT_NEAR(trackedFor(tracker, 7.3, showing(3.0)).scale, 7.3 / 7.0, 0.02);
}

TEST(RangeTracker, ALidarThatRepeatsItselfTeachesNoScale) {
  RangeTracker tracker = trackerWithLidar();
  EXPECT_EQ(trackedFor(tracker, 7.3, showing(3.0), true).scale, 1.0);
}

TEST(RangeTracker, AThingBesideTheBeamKeepsItFromTeachingTheScale) {
  RangeTracker tracker = trackerWithLidar();
  cv::Mat disparity_px = showing(3.0);
  disparity_px.colRange(165, 320).setTo(5.0);  // within six radii of the footprint, but not in it
  const TrackedRange tracked = trackedFor(tracker, 7.3, disparity_px);
  EXPECT_NEAR(tracked.range_stereo_m, 7.0, 1e-6);
  EXPECT_EQ(tracked.scale, 1.0);
}

TEST(RangeTracker, SensorsThatDifferPersistentlySaySo) {
  RangeTracker tracker = trackerWithLidar();
  const TrackedRange tracked = trackedFor(tracker, 4.7, showing(3.0));
  EXPECT_TRUE(reasonsOf(tracked) & kDisagreement);
  EXPECT_NEAR(tracked.range.range_m, 4.7, 0.02) << "the nearer one rules";
}

/// The first pair after two readings of a LiDAR.
TrackedRange atFirstSight(double lidar_m, double disparity_px) {
  RangeTracker tracker = trackerWithLidar();
  tracker.addRange(reading(0.99, lidar_m));
  tracker.addRange(reading(1.0, lidar_m + 0.001));
  return tracker.update(1.0, showing(disparity_px));
}

TEST(RangeTracker, StereoThatIsFarTooFarIsContradictedAtFirstSight) {
  const double expected_px = kSmallGeometry.disparity(8.8);
  for (const double disparity_px : {0.03, 0.1, 0.5, expected_px - 1.0}) {
    EXPECT_TRUE(atFirstSight(8.8, disparity_px).lidar_is_nearer) << disparity_px;
  }
  EXPECT_FALSE(atFirstSight(8.8, expected_px - 0.7).lidar_is_nearer) << "one sigma of the offset";
}

TEST(RangeTracker, ARigThatIsFartherOffThanWhatIsCorrectedIsKnownAtFirstSight) {
  for (const double factor : {1.2, 1.35, 1.5}) {  // announced over true baseline
    EXPECT_TRUE(atFirstSight(3.0, 7.0 / factor).lidar_is_nearer) << factor;
  }
  EXPECT_FALSE(atFirstSight(3.0, 7.0 / 1.1).lidar_is_nearer);
}

TEST(RangeTracker, AContradictionHoldsUntilTheTwoHaveAgreedForAsLong) {
  RangeTracker tracker = trackerWithLidar();
  ASSERT_TRUE(trackedFor(tracker, 3.0, showing(3.0)).lidar_is_nearer) << "for half a second";
  for (int i = 0; i < 100; ++i) {  // now both see 7 m
    const double stamp_s = 1.5 + 0.01 * i;
    tracker.addRange(reading(stamp_s, 7.0 + 0.001 * (i % 2)));
    const bool is_nearer = tracker.update(stamp_s, showing(3.0)).lidar_is_nearer;
    EXPECT_TRUE(is_nearer || i >= 40) << i;
    EXPECT_FALSE(is_nearer && i > 90) << i;
  }
}

TEST(RangeTracker, AnOffsetThatCanBePutRightIsLearntWhereverTheSensorsBegin) {
  constexpr double kOffset_px = 0.5;
  RangeTracker tracker = trackerWithLidar();
  TrackedRange tracked;
  for (int i = 0; i < 400; ++i) {  // from 9 m to 3 m
    const double stamp_s = 0.01 * i, true_m = 9.0 - 0.015 * i;
    tracker.addRange(reading(stamp_s, true_m + 0.001 * (i % 2)));
    if (i % 5 == 4) tracked = tracker.update(stamp_s, showing(kSmallGeometry.disparity(true_m) - kOffset_px));
  }
  EXPECT_FALSE(tracked.lidar_is_nearer);
  EXPECT_NEAR(tracked.range_stereo_m, 3.0, 0.1);
}

TEST(RangeTracker, ALostReadingDoesNotMakeANearerLidarForgotten) {
  RangeTracker tracker = trackerWithLidar();
  ASSERT_TRUE(trackedFor(tracker, 4.7, showing(3.0)).lidar_is_nearer);
  tracker.addRange(reading(1.5, kInfinity));
  const TrackedRange tracked = tracker.update(1.5, showing(3.0));
  EXPECT_TRUE(std::isnan(tracked.range_lidar_m));
  EXPECT_TRUE(tracked.lidar_is_nearer);
  EXPECT_FALSE(tracker.update(3.0, showing(3.0)).lidar_is_nearer) << "one that is silent says nothing";
}

TEST(RangeTracker, ANearerLidarIsForgottenThatHasNoUsableRangeAnyMore) {
  for (const double range_m : {kNaN, kInfinity, 0.0, 9509.0, 14.0}) {  // the last one is beyond what stereo shows
    RangeTracker tracker = trackerWithLidar();
    ASSERT_TRUE(trackedFor(tracker, 4.7, showing(3.0)).lidar_is_nearer);
    TrackedRange tracked;
    for (int i = 0; i < 120; ++i) {
      tracker.addRange(reading(1.5 + 0.01 * i, range_m + 0.001 * (i % 2)));
      if (i % 5 != 0) continue;
      tracked = tracker.update(1.5 + 0.01 * i, showing(3.0));
      EXPECT_TRUE(tracked.lidar_is_nearer || i > 10) << range_m << ", " << i;
    }
    EXPECT_FALSE(tracked.lidar_is_nearer) << range_m;
  }
}

TEST(RangeTracker, AnAccelerationThatNoRigHasChangesNothing) {
  RangeTracker tracker = trackerWithLidar();
  for (const double acceleration_mps2 : {1e3, -1e6, 1e308, kInfinity, kNaN}) {
    tracker.addAcceleration(1.2, {0.0, 0.0, acceleration_mps2});
  }
  EXPECT_NEAR(trackedFor(tracker, 3.0, showing(7.0)).range.range_m, 3.0, 0.01);
}

TEST(RangeTracker, ALidarThatPassesBetweenBarsForAMomentStaysValid) {
  RangeTracker tracker = trackerWithLidar();
  EXPECT_TRUE(trackedFor(tracker, 3.0, showing(7.0)).lidar_range_valid);
  constexpr double kPassed_s = 1.5;  // from then on
  for (int i = 0; i < 40; ++i) {
    const double stamp_s = kPassed_s + 0.01 * i, lasted_s = stamp_s - kPassed_s;
    tracker.addRange(reading(stamp_s, 14.0 + 0.001 * (i % 2)));
    const TrackedRange tracked = tracker.update(stamp_s, showing(7.0));
    ASSERT_TRUE(reasonsOf(tracked) & kLidarRejected);
    if (std::abs(lasted_s - Config().fusion.lasting_s) < 0.015) continue;
    EXPECT_EQ(tracked.lidar_range_valid, lasted_s < Config().fusion.lasting_s) << lasted_s;
  }
}

TEST(RangeTracker, ALidarThatMeetsSomethingNearerOrBecomesSlowIsNoLongerValid) {
  RangeTracker tracker = trackerWithLidar();
  ASSERT_TRUE(trackedFor(tracker, 3.0, showing(7.0)).lidar_range_valid);
  EXPECT_FALSE(RangeTracker(tracker).update(1.95, showing(7.0)).lidar_range_valid) << "slow";
  tracker.addRange(reading(1.5, 1.0));
  EXPECT_FALSE(tracker.update(1.5, showing(7.0)).lidar_range_valid) << "nearer";
}

TEST(RangeTracker, ALidarThatMetAnEdgeThatStereoShowsBesideTheBeamDoesNotContradictIt) {
  const double edge_px = kSmallGeometry.disparity(4.7);
  for (const double beside_px : {edge_px, edge_px + 0.6}) {
    RangeTracker tracker = trackerWithLidar();
    cv::Mat disparity_px = showing(3.0);
    disparity_px.colRange(162, 320).setTo(beside_px);  // within three radii of the beam, but not on it
    const TrackedRange tracked = trackedFor(tracker, 4.7, disparity_px);
    ASSERT_TRUE(reasonsOf(tracked) & kDisagreement);
    EXPECT_EQ(tracked.lidar_is_nearer, beside_px != edge_px);
  }
}

TEST(RangeTracker, WhatIsShownBesideTheBeamIsMeasuredWithTheLearntScale) {
  const double edge_px = kSmallGeometry.disparity(4.7);
  for (const bool has_learnt : {false, true}) {
    RangeTracker tracker = trackerWithLidar();
    for (int i = 0; i < 100; ++i) {  // a rig 10 % too far, or a faultless one
      tracker.addRange(reading(0.01 * i, 6.3 + 0.001 * (i % 2)));
      const double measured_m = has_learnt ? 7.0 : 6.3;
      if (i % 5 == 4) tracker.update(0.01 * i, showing(kSmallGeometry.disparity(measured_m)));
    }
    cv::Mat disparity_px = showing(3.0);
    disparity_px.colRange(162, 320).setTo(0.9 * edge_px);  // of 4.7 m, 10 % too far
    const TrackedRange tracked = trackedFor(tracker, 4.7, disparity_px);
    ASSERT_TRUE(reasonsOf(tracked) & kDisagreement);
    EXPECT_EQ(tracked.lidar_is_nearer, !has_learnt);
  }
}

TEST(RangeTracker, AFewMatchesBesideTheBeamShowNothing) {
  RangeTracker tracker = trackerWithLidar();
  ASSERT_TRUE(trackedFor(tracker, 4.7, showing(3.0)).lidar_is_nearer);
  cv::Mat disparity_px = showing(kNaN);
  disparity_px(cv::Rect(159, 119, 2, 2)).setTo(kSmallGeometry.disparity(4.7));
  EXPECT_TRUE(tracker.update(1.5, disparity_px).lidar_is_nearer);
}

TEST(RangeTracker, ALidarThatSaysTooCloseIsNearer) {
  RangeTracker tracker = trackerWithLidar();
  ASSERT_FALSE(trackedFor(tracker, 7.0, showing(3.0)).lidar_is_nearer);
  tracker.addRange(reading(1.5, -kInfinity));  // REP-117
  const TrackedRange tracked = tracker.update(1.5, showing(3.0));
  EXPECT_TRUE(tracked.lidar_is_nearer);
  EXPECT_TRUE(reasonsOf(tracked) & kDisagreement);
  tracker.addRange(reading(1.55, 7.0));
  EXPECT_FALSE(tracker.update(1.55, showing(3.0)).lidar_is_nearer);
}

}  // namespace
}  // namespace flight_corridor
