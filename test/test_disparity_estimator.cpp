#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>
#include <stdexcept>
#include <utility>

#include "flight_corridor/disparity_estimator.hpp"
#include "sim/simulation.hpp"
#include "support/calibrations.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using test_support::smallCalibration;
using test_support::wallFrame;

/// Share of pixels whose disparity lies within a quarter of a pixel of what it should be.
double shareRight(const cv::Mat& disparity_px, double expected_px) {
  const cv::Mat error = cv::abs(disparity_px - expected_px);
  return cv::countNonZero(error <= 0.25) / static_cast<double>(error.total());
}

bool contains(const ConvexRegion& region_C, const Eigen::Vector3d& p_C) {
  return ((region_C.transpose() * p_C.homogeneous()).array() >= 0.0).all();
}

/// A wall between whole disparities, with spots that have no texture.
StereoFrame spottedWall(const StereoGeometry& geometry, double disparity_px) {
  cv::Mat wall(geometry.size(), CV_8UC1);
  cv::RNG random(5);
  random.fill(wall, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(wall, wall, {0, 0}, 1.5);
  for (int v = 10; v < wall.rows; v += 24) {
    for (int u = 10; u < wall.cols; u += 24) cv::circle(wall, {u, v}, 5, cv::Scalar(128), cv::FILLED, cv::LINE_AA);
  }
  StereoFrame frame;
  frame.left = wall;
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1.0, 0.0, -disparity_px, 0.0, 1.0, 0.0);
  cv::warpAffine(wall, frame.right, shift, wall.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  return frame;
}

TEST(DisparityEstimator, FindsTheDisparityOfATexturedWall) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry);
  Disparity disparity;
  estimator.estimate(wallFrame(geometry, 12, 0.0), disparity);
  // What the right image cannot show (12 of 320 columns) and a block's border are left out.
  EXPECT_GT(shareRight(disparity.matched_px, 12.0), 0.90);
  EXPECT_GT(disparity.matched_fraction, 0.90);
  EXPECT_GT(shareRight(disparity.filtered_px, 12.0), 0.75);
}

TEST(DisparityEstimator, CamerasMayExposeDifferently) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry);
  Disparity disparity;
  for (const double gain : {0.5, 0.8, 1.25}) {
    StereoFrame frame = wallFrame(geometry, 12, 0.0);
    frame.left *= 0.7;  // so that nothing is saturated
    frame.right *= 0.7 * gain;
    estimator.estimate(frame, disparity);
    EXPECT_GT(shareRight(disparity.matched_px, 12.0), 0.90) << gain;
  }
}

TEST(DisparityEstimator, AWhiteSkyHidesNoDifferenceOfExposure) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry);
  Disparity disparity;
  const int horizon = geometry.size().height / 2;
  for (const double gain : {0.6, 1.6}) {
    StereoFrame frame = wallFrame(geometry, 12, 0.0);
    frame.left.convertTo(frame.left, -1, 0.6, 60.0);
    frame.right.convertTo(frame.right, -1, 0.6 * gain, 60.0 * gain);
    frame.left.rowRange(0, horizon).setTo(255);
    frame.right.rowRange(0, horizon).setTo(255);
    estimator.estimate(frame, disparity);
    EXPECT_GT(shareRight(disparity.matched_px.rowRange(horizon, disparity.matched_px.rows), 12.0), 0.94) << gain;
  }
}

/// A level branch with little texture in the upper half; the lower half is ground. Both have the same disparity.
StereoFrame branchBeforeWhiteSky(const StereoGeometry& geometry, int disparity_px, const cv::Range& branch) {
  StereoFrame frame = wallFrame(geometry, disparity_px, 0.0);
  for (cv::Mat* image : {&frame.left, &frame.right}) {
    image->convertTo(*image, -1, 0.4, 20.0);
    image->rowRange(branch).convertTo(image->rowRange(branch), -1, 0.25, 20.0);
    image->rowRange(0, branch.start).setTo(255);
    image->rowRange(branch.end, image->rows / 2).setTo(255);
  }
  return frame;
}

TEST(DisparityEstimator, ALevelBranchBeforeAWhiteSkyIsSeenAsWellWhateverTheExposures) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry);
  Disparity disparity;
  const cv::Range branch(60, 63);
  const auto share_seen = [&](double gain) {
    StereoFrame frame = branchBeforeWhiteSky(geometry, 12, branch);
    const cv::Mat sky = frame.right == 255;
    frame.right.convertTo(frame.right, -1, gain);
    frame.right.setTo(255, sky);
    estimator.estimate(frame, disparity);
    return shareRight(disparity.matched_px.rowRange(branch), 12.0);
  };
  const double equal = share_seen(1.0);
  EXPECT_GT(equal, 0.5);
  for (const double gain : {0.7, 1.03, 1.5}) EXPECT_NEAR(share_seen(gain), equal, 0.02) << gain;
}

TEST(DisparityEstimator, ACoveredLensGivesNoDisparity) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry);
  Disparity disparity;
  StereoFrame frame = wallFrame(geometry, 12, 0.0);
  cv::RNG random(3);
  random.fill(frame.right, cv::RNG::NORMAL, 10.0, 1.5);
  estimator.estimate(frame, disparity);
  EXPECT_LT(disparity.matched_fraction, StereoConfig().min_matched_fraction);
  frame.right.setTo(102);  // every disparity costs the same
  estimator.estimate(frame, disparity);
  EXPECT_EQ(disparity.matched_fraction, 0.0);
}

TEST(DisparityEstimator, RemovesThePrincipalPointDifferenceOnce) {
  for (const double difference_px : {-20.0, 7.0, 40.0}) {
    StereoCalibration calibration = smallCalibration();
    calibration.cx_right_px = calibration.cx_px - difference_px;
    const StereoGeometry geometry(calibration);
    DisparityEstimator estimator(StereoConfig(), geometry);
    Disparity disparity;
    estimator.estimate(wallFrame(geometry, 30, 0.0), disparity);
    EXPECT_GT(shareRight(disparity.matched_px, 30.0), 0.70) << "cx_l - cx_r = " << difference_px;
  }
}

TEST(DisparityEstimator, TheLeftStripIsMatchedAsFarAsTheRightImageShowsIt) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry);
  Disparity disparity;
  estimator.estimate(wallFrame(geometry, 8, 0.0), disparity);
  EXPECT_GT(shareRight(disparity.matched_px.colRange(16, 120), 8.0), 0.9);  // the search range is 128 px
  EXPECT_EQ(cv::countNonZero(disparity.matched_px.colRange(0, 4) > 4.0), 0);
}

TEST(DisparityEstimator, BlankImagesGiveNoDisparity) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry);
  StereoFrame frame;
  frame.left = frame.right = cv::Mat(geometry.size(), CV_8UC1, cv::Scalar(255));
  Disparity disparity;
  estimator.estimate(frame, disparity);
  EXPECT_EQ(disparity.matched_fraction, 0.0);
}

TEST(DisparityEstimator, TheFillInventsNothingWhereNothingMatched) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry);
  StereoFrame frame = wallFrame(geometry, 12, 0.0);
  frame.left.rowRange(0, 120).setTo(255);  // saturated sky
  frame.right.rowRange(0, 120).setTo(255);
  Disparity disparity;
  estimator.estimate(frame, disparity);
  EXPECT_EQ(cv::countNonZero(disparity.filtered_px.rowRange(0, 100) > 0.0), 0);
  EXPECT_GT(shareRight(disparity.filtered_px.rowRange(130, 240), 12.0), 0.75);
}

TEST(DisparityEstimator, NearThingsAreNotSpreadOverTheSky) {
  sim::SimulationOptions options;
  options.scene = "side_obstacles";
  options.seed = 4;
  options.rate_hz = 3.0;
  const sim::Simulation simulation(options);
  DisparityEstimator estimator(StereoConfig(), StereoGeometry(simulation.calibration()));
  Disparity disparity;
  estimator.estimate(simulation.frame(5), disparity);  // saturated above, a post beside the camera
  cv::Mat matched_around;
  cv::dilate(disparity.matched_px == disparity.matched_px, matched_around, cv::Mat::ones(31, 31, CV_8U));
  EXPECT_EQ(cv::countNonZero((disparity.filtered_px == disparity.filtered_px) & ~matched_around), 0);
}

TEST(DisparityEstimator, TheFillIsNotDrawnToWholePixels) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry);
  for (const double expected_px : {10.0, 10.3, 10.5, 11.0, 11.4}) {
    Disparity disparity;
    estimator.estimate(spottedWall(geometry, expected_px), disparity);
    const cv::Mat filled = ~(disparity.matched_px == disparity.matched_px) & (disparity.filtered_px > 0.0);
    ASSERT_GT(cv::countNonZero(filled), 1000) << expected_px;
    EXPECT_NEAR(cv::mean(disparity.filtered_px, filled)[0], expected_px, 0.1) << expected_px;  // one sigma of a match
  }
}

TEST(DisparityEstimator, ConfidenceLiesBetweenZeroAndOneAndWeakFillsAreLeftOut) {
  const StereoGeometry geometry(smallCalibration());
  const StereoConfig config;
  DisparityEstimator estimator(config, geometry);
  Disparity disparity;
  estimator.estimate(wallFrame(geometry, 12, 0.0), disparity);
  double low, high;
  cv::minMaxLoc(disparity.confidence, &low, &high);
  EXPECT_GE(low, 0.0);
  EXPECT_LE(high, 1.0);
  const cv::Mat weak = disparity.confidence < config.wls_min_confidence;
  EXPECT_EQ(cv::countNonZero((disparity.filtered_px == disparity.filtered_px) & weak), 0);
}

TEST(DisparityEstimator, TheSameFrameGivesTheSameDisparity) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator one(StereoConfig(), geometry), other(StereoConfig(), geometry);
  Disparity a, b;
  other.estimate(wallFrame(geometry, 40, 0.0), b);  // leaves its scratch images behind
  one.estimate(wallFrame(geometry, 9, 0.0), a);
  other.estimate(wallFrame(geometry, 9, 0.0), b);
  EXPECT_EQ(cv::countNonZero(a.matched_px == b.matched_px), cv::countNonZero(a.matched_px == a.matched_px));
  EXPECT_EQ(cv::countNonZero(b.matched_px == b.matched_px), cv::countNonZero(a.matched_px == a.matched_px));
}

TEST(DisparityEstimator, ObservesWhatBothImagesShowWithinTheSearchedRange) {
  const StereoGeometry geometry(smallCalibration());
  const ConvexRegion observable_C = DisparityEstimator(StereoConfig(), geometry).observable();
  EXPECT_TRUE(contains(observable_C, {0.0, 0.0, 4.0}));
  EXPECT_FALSE(contains(observable_C, {0.0, 0.0, -4.0}));
  EXPECT_FALSE(contains(observable_C, {0.0, 0.0, 0.1}));   // 210 px
  EXPECT_FALSE(contains(observable_C, {5.0, 0.0, 4.0}));   // outside the left image
  EXPECT_FALSE(contains(observable_C, {-0.9, 0.0, 1.0}));  // column 2 of the left image, 21 px outside the right one
}

TEST(DisparityEstimator, MatchesFarBelowZeroAreWrongAndALittleBelowTheyAreFar) {
  const StereoGeometry geometry(smallCalibration());
  const cv::Point middle(geometry.size() / 2);
  for (const int below_px : {1, 2}) {
    Disparity disparity;
    StereoFrame wall = wallFrame(geometry, below_px, 1.0);
    std::swap(wall.left, wall.right);
    DisparityEstimator(StereoConfig(), geometry).estimate(wall, disparity);
    const float matched_px = disparity.matched_px.at<float>(middle);
    if (below_px == 1) {
      EXPECT_EQ(matched_px, 1.0f / 16.0f);
    } else {
      EXPECT_TRUE(std::isnan(matched_px)) << matched_px;
    }
  }
}

TEST(DisparityEstimator, WhatItObservesIsWhatTheCalibrationProjectsOntoBothImages) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> sideways(-2.0, 2.0), depth(-0.5, 2.0);
  for (const double difference_px : {-20.0, 0.0, 7.3}) {
    StereoCalibration calibration = smallCalibration();
    calibration.cx_right_px = calibration.cx_px - difference_px;
    const StereoGeometry geometry(calibration);
    const StereoConfig config;
    const ConvexRegion observable_C = DisparityEstimator(config, geometry).observable();
    int observed = 0;
    for (int trial = 0; trial < 5000; ++trial) {
      const Eigen::Vector3d p_C(sideways(random), sideways(random), depth(random));
      const Eigen::Vector2d left_px = geometry.project(p_C);
      const double matched_px = geometry.disparity(p_C.z()) + difference_px;
      // The matcher searches from 2 px below zero, and gives no value at the last disparity.
      const double end_px = std::floor(difference_px) - 2 + config.num_disparities_px - 1;
      const bool expected = geometry.contains(left_px) && left_px.x() - matched_px >= 0.0 && matched_px < end_px;
      EXPECT_EQ(contains(observable_C, p_C), expected) << p_C.transpose() << ", " << difference_px << " px";
      observed += expected;
    }
    EXPECT_GT(observed, 500);
    EXPECT_LT(observed, 4500);
  }
}

TEST(DisparityEstimator, RefusesASearchWiderThanTheImage) {
  StereoConfig config;
  config.num_disparities_px = 320;
  EXPECT_THROW(DisparityEstimator(config, StereoGeometry(smallCalibration())), std::invalid_argument);
}

}  // namespace
}  // namespace flight_corridor
