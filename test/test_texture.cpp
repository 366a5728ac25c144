#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "flight_corridor/stereo/texture.hpp"

namespace flight_corridor {
namespace {

const cv::Size kSize(640, 480);
const cv::Rect kInner(16, 16, 608, 448);  // where windows lie on the image

/// Grey levels, rounded, with white noise.
cv::Mat noisy(const cv::Mat& grey, double sigma, std::uint64_t seed = 1) {
  cv::Mat noise(grey.size(), CV_32FC1), image;
  cv::RNG(seed).fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  noise += grey;
  noise.convertTo(image, CV_8UC1);
  return image;
}

/// Light that grows along a direction.
cv::Mat ramp(double per_column, double per_row) {
  cv::Mat grey(kSize, CV_32FC1);
  for (int v = 0; v < grey.rows; ++v) {
    for (int u = 0; u < grey.cols; ++u) {
      grey.at<float>(v, u) =
          static_cast<float>(128.0 + per_column * (u - grey.cols / 2) + per_row * (v - grey.rows / 2));
    }
  }
  return grey;
}

/// Upright waves.
cv::Mat waves(double amplitude, double period_px) {
  cv::Mat grey(kSize, CV_32FC1);
  for (int u = 0; u < grey.cols; ++u) grey.col(u) = 128.0 + amplitude * std::sin(2.0 * CV_PI * u / period_px);
  return grey;
}

double share(const cv::Mat& mask) { return cv::countNonZero(mask) / static_cast<double>(mask.total()); }

TEST(Texture, IsWhereTheViewIsCovered) {
  cv::Mat covered = cv::Mat::zeros(kSize, CV_8UC1);
  covered(cv::Rect(200, 100, 50, 40)) = 255;
  const cv::Mat image = noisy(ramp(0.0, 0.0), 1.0);
  Texture texture;
  const cv::Mat expected = texture.find(image) | covered;
  ASSERT_LT(share(expected), 0.1);
  EXPECT_EQ(cv::norm(texture.find(image, covered), expected, cv::NORM_INF), 0.0);
}

TEST(Texture, WhereTheImageIsClippedNothingIsKnownButAtAnEdge) {
  for (const int level : {0, 255}) {
    cv::Mat image = noisy(cv::Mat(kSize, CV_32FC1, cv::Scalar(128.0)), 2.0);
    image(cv::Rect(200, 100, 80, 60)) = level;
    Texture texture;
    texture.find(image);
    const cv::Rect inside(206, 104, 68, 52);  // half a window from its edges
    EXPECT_EQ(cv::countNonZero(texture.clipped()(inside)), inside.area()) << level;
    EXPECT_EQ(cv::countNonZero(texture.clipped() & texture.mask()), 0) << level;
    image(cv::Rect(200, 100, 80, 60)) = 128;
    texture.find(image);
    EXPECT_EQ(cv::countNonZero(texture.clipped()), 0) << level;
    image(cv::Rect(200, 100, 80, 60)) = level;
    texture.find(image, cv::Mat(kSize, CV_8UC1, cv::Scalar(255)));
    EXPECT_EQ(cv::countNonZero(texture.clipped()), 0) << "covered";
  }
}

/// The RMS of a block of 16 x 16 px is off by 6 %; that a fifth of the blocks have less makes 5 % of it.
TEST(Texture, TheNoiseIsThatOfWhatIsSmooth) {
  for (const double sigma : {1.0, 2.0, 3.0, 4.0, 5.0}) {
    const double truth = std::hypot(sigma, std::sqrt(1.0 / 12.0));  // rounded
    Texture texture;
    texture.find(noisy(ramp(0.1, 0.05), sigma));
    EXPECT_NEAR(texture.noise(), truth, 0.1 * truth);
    cv::Mat half = ramp(0.0, 0.0);
    waves(40.0, 7.0).colRange(0, 320).copyTo(half.colRange(0, 320));
    texture.find(noisy(half, sigma));
    EXPECT_NEAR(texture.noise(), truth, 0.1 * truth) << "the other half is textured";
    half.colRange(0, 320) = 300.0;
    texture.find(noisy(half, sigma));
    EXPECT_NEAR(texture.noise(), truth, 0.1 * truth) << "the other half is clipped";
  }
}

TEST(Texture, WhatShowsNoNoiseHasThatOfRounding) {
  Texture texture;
  texture.find(cv::Mat(kSize, CV_8UC1, cv::Scalar(100)));
  EXPECT_GT(texture.noise(), std::sqrt(1.0 / 12.0));
  EXPECT_LT(texture.noise(), 1.0);
  EXPECT_EQ(cv::countNonZero(texture.mask()), 0);
}

TEST(Texture, ABareImageWithNoiseAndARampHasNone) {
  for (const double sigma : {0.5, 1.0, 3.0, 5.0}) {
    for (const auto& [per_column, per_row] : {std::pair(0.0, 0.0), std::pair(0.15, 0.0), std::pair(0.1, -0.2)}) {
      Texture texture;
      EXPECT_LT(share(texture.find(noisy(ramp(per_column, per_row), sigma))), 0.01)
          << sigma << " grey, " << per_column << " " << per_row;
    }
  }
}

TEST(Texture, AnEdgeAlongTheRowsIsNone) {
  cv::Mat grey = ramp(0.0, 0.0);
  grey.rowRange(240, 480) = 60.0;
  Texture texture;
  EXPECT_LT(share(texture.find(noisy(grey, 2.0))), 0.01);
}

TEST(Texture, WhatIsAboveTheNoiseIsSomeInEveryWindow) {
  for (const double sigma : {1.0, 2.0, 4.0}) {
    for (const double period_px : {2.7, 3.0, 5.0, 6.0, 8.0, 12.0}) {
      cv::Mat grey = waves(4.0 * sigma, period_px);
      grey.rowRange(0, 160) = 128.0;  // shows what noise is
      Texture texture;
      texture.find(noisy(grey, sigma));
      EXPECT_GT(share(texture.mask().rowRange(170, 470).colRange(16, 624)), 0.99)
          << sigma << ", " << period_px << " px";
      EXPECT_LT(share(texture.mask().rowRange(0, 150)), 0.01) << sigma;
    }
  }
}

TEST(Texture, AnUprightEdgeIsSomeAsWideAsTheWindow) {
  cv::Mat grey = ramp(0.0, 0.0);
  grey.colRange(320, 640) = 160.0;
  Texture texture;
  texture.find(noisy(grey, 2.0));
  EXPECT_GT(share(texture.mask()(cv::Rect(318, 16, 4, 448))), 0.99);
  EXPECT_LT(share(texture.mask()(cv::Rect(16, 16, 290, 448))), 0.01);
  EXPECT_LT(share(texture.mask()(cv::Rect(334, 16, 290, 448))), 0.01);
}

TEST(Texture, AnOffsetOfAllGreyLevelsChangesNothing) {
  const cv::Mat grey = noisy(waves(5.0, 9.0), 3.0);  // from 100 to 160
  Texture one, other;
  one.find(grey);
  other.find(grey + 60);
  EXPECT_EQ(one.noise(), other.noise());
  EXPECT_EQ(cv::countNonZero(one.mask() != other.mask()), 0);
}

/// Of a scene of patches with and without texture, nearly half of them.
TEST(Texture, AShiftOfTheImageShiftsTheMask) {
  cv::Mat field(8, 10, CV_32FC1), contrast, grain(kSize, CV_32FC1);
  cv::RNG random(5);
  random.fill(field, cv::RNG::UNIFORM, -15.0, 20.0);
  field = cv::max(field, 0.0);
  cv::resize(field, contrast, kSize, 0.0, 0.0, cv::INTER_NEAREST);
  random.fill(grain, cv::RNG::UNIFORM, -1.0, 1.0);
  const cv::Mat grey = noisy(128.0 + contrast.mul(grain), 1.0);
  const cv::Size view(600, 440);
  Texture one, other;
  one.find(grey({cv::Point(0, 0), view}));
  ASSERT_GT(share(one.mask()), 0.2);
  ASSERT_LT(share(one.mask()), 0.95);
  for (const cv::Point shift : {cv::Point(1, 0), cv::Point(0, 1), cv::Point(17, 9), cv::Point(32, 32)}) {
    other.find(grey({shift, view}));
    const cv::Size both = kInner.size() - cv::Size(80, 80);
    const cv::Mat moved = one.mask()({cv::Point(16, 16) + shift, both}) != other.mask()({cv::Point(16, 16), both});
    EXPECT_LT(share(moved), 0.01) << shift << ": the noise is that of other blocks";
  }
}

TEST(Texture, TurningTheImageUpsideDownTurnsTheMask) {
  const cv::Mat grey = noisy(waves(4.0, 9.0), 3.0);
  cv::Mat flipped, mask;
  cv::flip(grey, flipped, 0);
  Texture one, other;
  one.find(grey);
  cv::flip(other.find(flipped), mask, 0);
  EXPECT_EQ(cv::countNonZero(one.mask() != mask), 0);
}

TEST(Texture, AnImageSmallerThanABlockIsTakenAsItIs) {
  Texture texture;
  EXPECT_EQ(texture.find(cv::Mat(3, 5, CV_8UC1, cv::Scalar(90))).size(), cv::Size(5, 3));
  EXPECT_EQ(cv::countNonZero(texture.mask()), 0);
}

}  // namespace
}  // namespace flight_corridor
