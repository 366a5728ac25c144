#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/disparity_refiner.hpp"

namespace flight_corridor {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

/// A textured wall at a disparity that need not be whole, the right image brighter by a tenth.
struct Pair {
  cv::Mat left, right;
  explicit Pair(double disparity_px) {
    cv::Mat texture(120, 240, CV_32FC1);
    cv::RNG random(7);
    random.fill(texture, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(texture, texture, {0, 0}, 1.5);
    cv::Mat shifted;
    const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, -disparity_px, 0, 1, 0);
    cv::warpAffine(texture, shifted, shift, texture.size(), cv::INTER_CUBIC);
    texture.convertTo(left, CV_8U);
    shifted.convertTo(right, CV_8U, 1.1, 5.0);
  }
};

/// @return what is thin.
cv::Mat refine(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px) {
  cv::Mat thin;
  DisparityRefiner().refine(left, right, disparity_px, thin);
  return thin;
}

cv::Rect inside(const cv::Mat& image) { return {40, 20, image.cols - 80, image.rows - 40}; }

TEST(DisparityRefiner, FindsTheFractionThatAMatcherRoundedAwayToATwentiethOfAPixel) {
  for (const double true_px : {9.6, 9.75, 9.9, 10.0, 10.2, 10.25, 10.4}) {
    const Pair pair(true_px);
    cv::Mat disparity_px(pair.left.size(), CV_32FC1, cv::Scalar(10.0));
    refine(pair.left, pair.right, disparity_px);
    cv::Scalar mean, sigma;
    cv::meanStdDev(disparity_px(inside(disparity_px)), mean, sigma);
    EXPECT_NEAR(mean[0], true_px, 0.05) << true_px;
    EXPECT_LT(sigma[0], 0.05) << true_px;
  }
}

TEST(DisparityRefiner, WhatWasNothingStaysNothing) {
  const Pair pair(10.0);
  cv::Mat disparity_px(pair.left.size(), CV_32FC1, cv::Scalar(10.0));
  disparity_px(cv::Rect(100, 50, 30, 20)).setTo(kNothing);
  const cv::Mat something = disparity_px == disparity_px;
  refine(pair.left, pair.right, disparity_px);
  EXPECT_EQ(cv::countNonZero((disparity_px == disparity_px) != something), 0);
}

TEST(DisparityRefiner, AStepBetweenSurfacesStaysAStep) {
  const cv::Mat blank(120, 240, CV_8UC1, cv::Scalar(90));  // nothing to register: the mean alone
  cv::Mat disparity_px(blank.size(), CV_32FC1, cv::Scalar(5.0));
  disparity_px.colRange(120, 124).setTo(11.0);
  const cv::Mat before = disparity_px.clone();
  refine(blank, blank, disparity_px);
  EXPECT_LT(cv::norm(disparity_px, before, cv::NORM_INF), 1e-5);
}

TEST(DisparityRefiner, WhatIsAmongMoreOfOtherSurfacesIsThin) {
  const cv::Mat blank(120, 240, CV_8UC1, cv::Scalar(90));
  cv::Mat disparity_px(blank.size(), CV_32FC1, cv::Scalar(5.0));
  disparity_px.colRange(120, 125).setTo(11.0);
  cv::Mat thin = refine(blank, blank, disparity_px);
  EXPECT_EQ(cv::countNonZero(thin.colRange(120, 125)), 5 * thin.rows);
  EXPECT_EQ(cv::countNonZero(thin), 5 * thin.rows);  // not the background's edge

  disparity_px.colRange(0, 120).setTo(kNothing);  // nothing else around
  disparity_px.colRange(125, 240).setTo(kNothing);
  thin = refine(blank, blank, disparity_px);
  EXPECT_EQ(cv::countNonZero(thin), 0);
}

TEST(DisparityRefiner, AThingsMiddleIsNoLessThinThanItsEdgesAndAWallsCornerIsNot) {
  const cv::Mat blank(120, 240, CV_8UC1, cv::Scalar(90));
  const auto thin_of = [&](const cv::Rect& thing) {
    cv::Mat disparity_px(blank.size(), CV_32FC1, cv::Scalar(5.0));
    disparity_px(thing).setTo(11.0);
    return cv::Mat(refine(blank, blank, disparity_px)(thing));
  };
  const cv::Mat leaf = thin_of({100, 50, 11, 11});
  EXPECT_NE(leaf.at<std::uint8_t>(5, 5), 0);                   // of what is around it most is its own
  EXPECT_EQ(cv::countNonZero(thin_of({100, 50, 16, 16})), 0);  // of what is around its corners little is
}

TEST(DisparityRefiner, NoiseOnOneSurfaceIsAveraged) {
  const cv::Mat blank(120, 240, CV_8UC1, cv::Scalar(90));
  cv::Mat disparity_px(blank.size(), CV_32FC1);
  cv::RNG(3).fill(disparity_px, cv::RNG::NORMAL, 8.0, 0.15);
  refine(blank, blank, disparity_px);
  cv::Scalar mean, sigma;
  cv::meanStdDev(disparity_px(inside(disparity_px)), mean, sigma);
  EXPECT_NEAR(mean[0], 8.0, 0.01);
  EXPECT_LT(sigma[0], 0.05);
}

TEST(DisparityRefiner, DisparitiesThatPointOutsideTheImageDoNoHarm) {
  const Pair pair(10.0);
  cv::Mat disparity_px(pair.left.size(), CV_32FC1, cv::Scalar(500.0));
  disparity_px.rowRange(0, 60).setTo(-500.0);
  const cv::Mat before = disparity_px.clone();
  refine(pair.left, pair.right, disparity_px);
  EXPECT_EQ(cv::norm(disparity_px, before, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace flight_corridor
