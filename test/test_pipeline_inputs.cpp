#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "flight_corridor/map/box_cells.hpp"
#include "flight_corridor/pipeline.hpp"
#include "support/calibrations.hpp"
#include "support/pipeline_inputs.hpp"
#include "support/wall_scene.hpp"

// Inputs that are missing, broken, frozen or not to be trusted.

namespace flight_corridor {
namespace {

using namespace test_support;

TEST(PipelineInputs, ReadingsThatAreNoRangesAreCountedAndNamed) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  for (const double range : {kNaN, kInfinity, -kInfinity, 0.0, 0.1, 9509.0}) pipeline.addRange(reading(1.0, range));
  const Report& report = pipeline.process(wallFrame(kSmallGeometry, 3, 1.0));
  EXPECT_EQ(pipeline.counters().lidar, 6u);
  EXPECT_EQ(pipeline.counters().lidar_invalid, 6u);
  EXPECT_TRUE(report.verdict.reasons & kNoLidar);
  EXPECT_TRUE(report.verdict.reasons & kLidarRejected);
}

TEST(PipelineInputs, BadInputIsUnknownWithItsReason) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  StereoFrame good = wallFrame(kSmallGeometry, 3, 1.0), bad = good;
  bad.right = cv::Mat();
  EXPECT_EQ(pipeline.process(bad).verdict.reasons, kBadImage);
  bad.right = good.right.rowRange(0, 100);
  EXPECT_EQ(pipeline.process(bad).verdict.reasons, kBadImage);
  good.right.convertTo(bad.right, CV_16U);
  EXPECT_EQ(pipeline.process(bad).verdict.reasons, kBadImage);
  bad = good;
  bad.stamp_s = kNaN;
  EXPECT_EQ(pipeline.process(bad).verdict.reasons, kNoData);
  EXPECT_EQ(pipeline.process(bad).verdict.state, State::Unknown);
  EXPECT_EQ(pipeline.counters().frames_refused, 5u);
}

TEST(PipelineInputs, OneCameraOnBothTopicsIsNeverFree) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  StereoFrame frame = wallFrame(kSmallGeometry, 7, 1.0);
  frame.right = frame.left.clone();
  const Report& report = pipeline.process(frame);
  EXPECT_EQ(report.verdict.state, State::Unknown);
  EXPECT_TRUE(report.verdict.reasons & kBadImage);
}

TEST(PipelineInputs, FrozenCamerasAreNeverFree) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  StereoFrame frame = wallFrame(kSmallGeometry, 3, 1.0);
  EXPECT_EQ(pipeline.process(frame).verdict.state, State::Free);
  frame.stamp_s = 1.1;
  EXPECT_EQ(pipeline.process(frame).verdict.state, State::Unknown);
  EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.2)).verdict.state, State::Free);
  StereoFrame half = wallFrame(kSmallGeometry, 3, 1.3);
  frame = wallFrame(kSmallGeometry, 3, 1.2);
  half.right = frame.right;
  const Report& report = pipeline.process(half);
  EXPECT_NE(report.verdict.state, State::Free);
  EXPECT_TRUE(report.verdict.reasons & kFrozenImage);
}

TEST(PipelineInputs, WhatIsNotTrustedClearsNothing) {
  Config config;
  config.map.frame_id = "odom";
  Pipeline pipeline(config, kSmallGeometry, rigWithLidar());
  StereoFrame frame = wallFrame(kSmallGeometry, 3, 1.0);
  EXPECT_TRUE(pipeline.process(frame, Eigen::Isometry3d::Identity()).clears);
  const Eigen::Isometry3d turned(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY()));
  frame.stamp_s = 1.1;  // frozen, while the rig has turned to where nobody looked
  EXPECT_FALSE(pipeline.process(frame, turned).clears);
  EXPECT_EQ(pipeline.map().tree().search(1.45, 0.05, 0.05), nullptr);
  pipeline.addRange(reading(1.2, -kInfinity));  // something is too close
  EXPECT_FALSE(pipeline.process(wallFrame(kSmallGeometry, 3, 1.2), turned).clears);
  EXPECT_TRUE(pipeline.process(wallFrame(kSmallGeometry, 3, 2.0), turned).clears);
}

TEST(PipelineInputs, FrozenCamerasStillBlock) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  StereoFrame frame = wallFrame(kSmallGeometry, 7, 1.0);
  pipeline.process(frame);
  frame.stamp_s = 1.1;
  EXPECT_EQ(pipeline.process(frame).verdict.state, State::Blocked);
}

TEST(PipelineInputs, AMapInTheWorldNeedsAPose) {
  Config config;
  config.map.frame_id = "odom";
  Pipeline pipeline(config, kSmallGeometry, rigWithLidar());
  EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.0)).verdict.reasons, kNoPose);
  Eigen::Isometry3d broken = Eigen::Isometry3d::Identity();
  broken.translation().x() = kNaN;
  EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.0), broken).verdict.reasons, kNoPose);
  for (const Eigen::Vector3d& scale : {Eigen::Vector3d(2, 2, 2), Eigen::Vector3d(1, 1, -1)}) {
    broken = Eigen::Scaling(scale);
    EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.0), broken).verdict.reasons, kNoPose)
        << scale.transpose();
  }
  EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.0), Eigen::Isometry3d::Identity()).verdict.state,
            State::Free);
}

TEST(PipelineInputs, AMapInTheWorldNeedsAPoseThatItReaches) {
  Config config;
  config.map.frame_id = "odom";
  const double farthest_m = farthestCamera(config.map);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double coordinate_m : {-1e308, -1.01 * farthest_m, 1.01 * farthest_m, 1e308}) {
      Pipeline pipeline(config, kSmallGeometry, rigWithLidar());
      Eigen::Isometry3d T_W_C = Eigen::Isometry3d::Identity();
      T_W_C.translation()[axis] = coordinate_m;
      EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.0), T_W_C).verdict.reasons, kNoPose) << coordinate_m;
      T_W_C.translation()[axis] = std::copysign(farthest_m, coordinate_m);
      pipeline.process(wallFrame(kSmallGeometry, 7, 1.1), T_W_C);
      EXPECT_LT(nearestOccupied(pipeline.map().tree(), pipeline.box()).clear_distance_m, kInfinity)
          << T_W_C.translation();
    }
  }
}

TEST(PipelineInputs, APairFromBeforeTheLastOneIsNoData) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  pipeline.process(wallFrame(kSmallGeometry, 3, 1.0));
  EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 0.9)).verdict.reasons, kNoData);
  EXPECT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.1)).verdict.state, State::Free);
}

TEST(PipelineInputs, ARigThatSeesNothingBeforeTheCorridorsLastQuarterIsRefused) {
  Config config;
  config.stereo.num_disparities_px = 96;
  StereoCalibration calibration = smallCalibration();
  calibration.baseline_m = 2.0;  // 3.8 m at 93 px
  try {
    Pipeline(config, StereoGeometry(calibration), rigWithLidar());
    FAIL() << "was taken";
  } catch (const std::invalid_argument& error) {
    const std::string complaint = error.what();
    for (const char* part : {"3.7", "4 m", "baseline", "num_disparities_px"}) {
      EXPECT_NE(complaint.find(part), std::string::npos) << complaint;
    }
  }
}

TEST(PipelineInputs, SpaceBeforeTheNearestDepthIsUnobserved) {
  Config config;
  config.stereo.num_disparities_px = 32;  // 0.7 m: beyond corridor/blind_m
  Pipeline pipeline(config, kSmallGeometry, rigWithLidar());
  EXPECT_FALSE(pipeline.seesFromBlind());
  // Of the box's width both cameras see no more than this, with the small rig's 0.914 m at 1 m to either side.
  const auto seenWidth = [](double depth_m) {
    return std::min(0.6, 0.914 * depth_m) + std::min(0.6, 0.914 * depth_m - kSmallGeometry.calibration().baseline_m);
  };
  double blind_m2 = 0.0, seen_m2 = 0.0;
  for (double depth_m = config.corridor.blind_m; depth_m < config.corridor.length_m; depth_m += 0.01) {
    seen_m2 += seenWidth(depth_m);
    if (depth_m < pipeline.nearestDepth()) blind_m2 += seenWidth(depth_m);
  }
  const Verdict verdict = pipeline.process(wallFrame(kSmallGeometry, 3, 1.0)).verdict;
  EXPECT_NEAR(verdict.unknown_fraction, blind_m2 / seen_m2, 0.02);  // depths are sampled, here by 7 cm of 3.6 m
  const auto near = [&](double from_m, double length_m) {
    return pipeline.query({opticalFromForward() * Eigen::Translation3d(from_m, 0, 0), {length_m, 0.3, 0.2}});
  };
  EXPECT_EQ(near(0.3, 0.4).state, State::Unknown);
  EXPECT_EQ(near(0.8, 0.4).state, State::Free);
}

/// A rig that measures everything 10 % too far, or too near, has learnt so: its nearest match is nearer, or farther.
TEST(PipelineInputs, TheNearestDepthIsThatOfTheLearntScale) {
  Config config;
  config.stereo.num_disparities_px = 32;
  constexpr int kNearest_px = 29;  // 0.72 m, of 31 px
  for (const double factor : {0.9, 1.1}) {
    Pipeline pipeline(config, kSmallGeometry, rigWithLidar());
    const double announced_m = pipeline.nearestDepth();
    for (int i = 0; i < 40; ++i) {
      for (int k = 9; k >= 0; --k) pipeline.addRange(reading(1.0 + 0.1 * i - 0.01 * k, 7.0 * factor + 0.001 * (k % 2)));
      pipeline.process(wallFrame(kSmallGeometry, 3, 1.0 + 0.1 * i));
    }
    ASSERT_NEAR(pipeline.scale().scale(3.0), factor, 0.03);
    EXPECT_NEAR(pipeline.nearestDepth() / announced_m, pipeline.scale().scale(kNearest_px), 0.02);
    const Verdict verdict = pipeline.process(wallFrame(kSmallGeometry, kNearest_px, 6.0)).verdict;
    EXPECT_EQ(verdict.reasons & kOccupiedCell, kOccupiedCell) << describeReasons(verdict.reasons);
  }
}

TEST(PipelineInputs, ARigThatIsBlindTooFarIsNeverFree) {
  Config config;
  config.stereo.num_disparities_px = 32;
  StereoCalibration calibration = smallCalibration();
  calibration.baseline_m = 0.24;  // 1.45 m
  const StereoGeometry geometry(calibration);
  Pipeline pipeline(config, geometry, rigWithLidar());
  for (int i = 0; i < 5; ++i) {
    const Verdict verdict = pipeline.process(wallFrame(geometry, 6, 1.0 + 0.1 * i)).verdict;
    EXPECT_EQ(verdict.state, State::Unknown);
    EXPECT_TRUE(verdict.reasons & kUnobserved);
  }
}

TEST(PipelineInputs, RefusesABrokenConfiguration) {
  Config config;
  config.corridor.height_m = 0.0;
  EXPECT_THROW(Pipeline(config, kSmallGeometry, rigWithLidar()), std::invalid_argument);
}

}  // namespace
}  // namespace flight_corridor
