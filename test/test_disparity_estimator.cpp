#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "flight_corridor/disparity_estimator.hpp"
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
  EXPECT_EQ(cv::countNonZero(a.matched_px != b.matched_px), cv::countNonZero(a.matched_px != a.matched_px));
}

TEST(DisparityEstimator, ObservesWhatBothImagesShowWithinTheSearchedRange) {
  const StereoGeometry geometry(smallCalibration());
  const DisparityEstimator estimator(StereoConfig(), geometry);
  EXPECT_TRUE(estimator.observes({0.0, 0.0, 4.0}));
  EXPECT_FALSE(estimator.observes({0.0, 0.0, -4.0}));
  EXPECT_FALSE(estimator.observes({0.0, 0.0, 0.1}));   // 210 px
  EXPECT_FALSE(estimator.observes({5.0, 0.0, 4.0}));   // outside the left image
  EXPECT_FALSE(estimator.observes({-0.9, 0.0, 1.0}));  // column 2 of the left image, 21 px outside the right one
}

TEST(DisparityEstimator, RefusesASearchWiderThanTheImage) {
  StereoConfig config;
  config.num_disparities_px = 320;
  EXPECT_THROW(DisparityEstimator(config, StereoGeometry(smallCalibration())), std::invalid_argument);
}

}  // namespace
}  // namespace flight_corridor
