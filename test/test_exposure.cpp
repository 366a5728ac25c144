#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "flight_corridor/stereo/exposure.hpp"

namespace flight_corridor {
namespace {

constexpr int kSky_rows = 60;

/// Grey 40 to 140: what gains up to 1.8 leave unclipped.
cv::Mat ground() {
  cv::Mat image(120, 160, CV_8UC1);
  cv::RNG(11).fill(image, cv::RNG::UNIFORM, 40, 141);
  return image;
}

cv::Mat underWhiteSky(cv::Mat image) {
  image.rowRange(0, kSky_rows).setTo(255);
  return image;
}

cv::Mat exposed(const cv::Mat& image, double gain, double offset = 0.0) {
  cv::Mat out;
  image.convertTo(out, -1, gain, offset);
  return out;
}

cv::Mat balanced(const cv::Mat& left, const cv::Mat& right) {
  cv::Mat out;
  balanceExposure(left, right, out);
  return out;
}

double largestDifference(const cv::Mat& one, const cv::Mat& other) { return cv::norm(one, other, cv::NORM_INF); }

TEST(Exposure, IsTheLeftOnesWhateverTheGainAndTheOffset) {
  for (const double gain : {0.5, 0.8, 1.0, 1.7}) {
    EXPECT_LE(largestDifference(balanced(ground(), exposed(ground(), gain, 5.0)), ground()), 2.0) << gain;
  }
}

TEST(Exposure, AWhiteSkyHidesNoDifferenceAndStaysWhite) {
  const cv::Mat left = underWhiteSky(ground());
  for (const double gain : {0.6, 1.03, 1.7}) {
    const cv::Mat right = underWhiteSky(exposed(ground(), gain));
    EXPECT_LE(largestDifference(balanced(left, right), left), 2.0) << gain;
  }
}

TEST(Exposure, WhiteThatTheLeftCameraDoesNotSeeIsDarkenedWithTheRest) {
  cv::Mat right = exposed(ground(), 1.7);
  right.rowRange(0, 10).setTo(255);  // glare
  const cv::Mat out = balanced(ground(), right);
  EXPECT_LT(out.at<std::uint8_t>(5, 5), 200);
  EXPECT_LE(cv::norm(out.rowRange(10, 120), ground().rowRange(10, 120), cv::NORM_L1) / (110 * 160), 8.0);
}

TEST(Exposure, OfACoveredLensTheContrastIsLeft) {
  const cv::Mat covered = exposed(ground(), 0.05);
  cv::Scalar mean, contrast, before, contrast_before;
  cv::meanStdDev(balanced(ground(), covered), mean, contrast);
  cv::meanStdDev(covered, before, contrast_before);
  EXPECT_NEAR(contrast[0], contrast_before[0], 0.1);
}

TEST(Exposure, WhatIsAllClippedIsLeftAsItIs) {
  const cv::Mat white(120, 160, CV_8UC1, cv::Scalar(255)), black(120, 160, CV_8UC1, cv::Scalar(0));
  cv::Mat halves = black.clone();
  halves.rowRange(0, kSky_rows).setTo(255);
  for (const cv::Mat& left : {ground(), white, black, halves}) {
    for (const cv::Mat& right : {white, black}) EXPECT_EQ(largestDifference(balanced(left, right), right), 0.0);
  }
}

TEST(Exposure, TakesPartsOfImages) {
  const cv::Rect part(3, 5, 90, 70);
  const cv::Mat right = exposed(ground(), 1.5);
  const cv::Mat expected = balanced(ground()(part).clone(), right(part).clone());
  EXPECT_EQ(largestDifference(balanced(ground()(part), right(part)), expected), 0.0);
}

}  // namespace
}  // namespace flight_corridor
