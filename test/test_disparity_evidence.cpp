#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

#include "flight_corridor/stereo/disparity_estimator.hpp"
#include "flight_corridor/stereo/search_range.hpp"

namespace flight_corridor {
namespace {

const cv::Size kSize(200, 90);
constexpr int kDisparities = 64;

StereoGeometry geometry(double difference_px) {
  return StereoGeometry({kSize, 200.0, 200.0, 100.0, 45.0, 100.0 - difference_px, 0.1});
}

DisparityEstimator estimator(const StereoGeometry& geometry, int num_disparities = kDisparities) {
  StereoConfig config;
  config.num_disparities_px = num_disparities;
  return {config, geometry, 0.05};
}

/// Noise, moved by what u_l - u_r is.
StereoFrame shifted(int shift_px) {
  StereoFrame frame;
  cv::Mat wide(kSize.height, kSize.width + 200, CV_8UC1);
  cv::RNG(1).fill(wide, cv::RNG::UNIFORM, 0, 256);
  frame.left = wide(cv::Rect({100, 0}, kSize));
  frame.right = wide(cv::Rect({100 + shift_px, 0}, kSize));
  return frame;
}

/// Whether the images do not contradict a disparity.
bool inSet(const DisparityEvidence& evidence, const StereoGeometry& geometry, int u, int v, double disparity_px) {
  const auto bit = static_cast<int>(std::lround(disparity_px - firstDisparity(geometry)));
  return evidence.set.ptr(v, u)[bit / 8] >> bit % 8 & 1;
}

TEST(DisparityEvidence, TakesThePrincipalPointDifferenceOff) {
  constexpr int kTruth_px = 21;
  for (const int difference_px : {0, 13, -40}) {
    DisparityEstimator matcher = estimator(geometry(difference_px));
    DisparityEvidence evidence;
    matcher.match(shifted(kTruth_px + difference_px), evidence);
    for (int v = 5; v < kSize.height - 5; ++v) {
      for (int u = 45; u < kSize.width - 45; ++u) {
        ASSERT_NEAR(evidence.best_px.at<float>(v, u), kTruth_px, 0.25) << difference_px << ": " << u << " " << v;
        ASSERT_TRUE(inSet(evidence, geometry(difference_px), u, v, kTruth_px));
        ASSERT_TRUE(evidence.flags.at<std::uint8_t>(v, u) & kConsistent);
      }
    }
  }
}

TEST(DisparityEvidence, SaysOfWhichMatchesAPatternHasAPlaceFartherAway) {
  constexpr int kPeriod_px = 12, kTruth_px = 21;
  StereoFrame frame = shifted(kTruth_px);
  for (cv::Mat* image : {&frame.left, &frame.right}) {
    const int shift_px = image == &frame.left ? 0 : kTruth_px;
    *image = image->clone();
    for (int v = 40; v < kSize.height; ++v) {
      for (int u = 0; u < kSize.width; ++u) {
        image->at<std::uint8_t>(v, u) = (u + shift_px) % kPeriod_px < kPeriod_px / 2 ? 40 : 200;
      }
    }
  }
  DisparityEstimator matcher = estimator(geometry(0.0));
  DisparityEvidence evidence;
  matcher.match(frame, evidence);
  const cv::Rect noise(70, 5, 80, 25), stripes(70, 50, 80, 30);
  const auto share = [](const cv::Mat& map) { return cv::countNonZero(map == map) / static_cast<double>(map.total()); };
  EXPECT_GT(share(evidence.best_px(noise)), 0.9);
  EXPECT_EQ(share(evidence.repeated_px(noise)), 0.0);
  EXPECT_EQ(share(evidence.best_px(stripes)), 0.0);
}

TEST(DisparityEvidence, HasNoMatchBehindInfinity) {
  DisparityEstimator matcher = estimator(geometry(0.0));
  DisparityEvidence evidence;
  matcher.match(shifted(-2), evidence);
  const cv::Mat seen_px = evidence.best_px.colRange(10, kSize.width - 10);  // in both images, the census's window too
  EXPECT_EQ(cv::countNonZero(seen_px == seen_px), 0);
  matcher.match(shifted(0), evidence);
  EXPECT_GT(evidence.best_px.at<float>(40, 100), 0.0f);  // as far as can be resolved
}

/// Fraction of a map's pixels, 4 px from its borders and where all disparities are seen.
double inside(const cv::Mat& pixels) {
  const cv::Mat seen = pixels(cv::Rect({kDisparities + 4, 4}, cv::Point(kSize.width - 4, kSize.height - 4)));
  return cv::countNonZero(seen) / static_cast<double>(seen.total());
}

double matched(const DisparityEvidence& evidence) {
  return cv::countNonZero(evidence.best_px == evidence.best_px) / static_cast<double>(kSize.area());
}

cv::Mat distinct(const DisparityEvidence& evidence) { return (evidence.flags & kDistinct) != 0; }

DisparityEvidence evidenceOf(const StereoFrame& frame) {
  DisparityEvidence evidence;
  estimator(geometry(0.0)).match(frame, evidence);
  return evidence;
}

TEST(DisparityEvidence, MatchesNothingOnAFlatSurface) {
  StereoFrame frame;
  frame.left = frame.right = cv::Mat(kSize, CV_8UC1, cv::Scalar(128));
  const DisparityEvidence evidence = evidenceOf(frame);
  EXPECT_EQ(cv::countNonZero(distinct(evidence)), 0);
  EXPECT_EQ(matched(evidence), 0.0);
}

TEST(DisparityEvidence, DistinguishesTexture) {
  const DisparityEvidence evidence = evidenceOf(shifted(20));
  EXPECT_GT(inside(distinct(evidence)), 0.9);
  EXPECT_GT(inside(evidence.best_px == evidence.best_px), 0.9);
}

TEST(DisparityEvidence, ReusesItsOutputs) {
  DisparityEstimator matcher = estimator(geometry(0.0));
  DisparityEvidence evidence;
  matcher.match(shifted(10), evidence);
  const void* const memory = evidence.best_px.data;
  matcher.match(shifted(12), evidence);
  EXPECT_EQ(evidence.best_px.data, memory);
}

TEST(DisparityEvidence, RefusesTheImpossible) { EXPECT_THROW(estimator(geometry(0.0), 100), std::invalid_argument); }

std::string refusal(const StereoFrame& frame) {
  DisparityEstimator matcher = estimator(geometry(0.0));
  DisparityEvidence evidence;
  try {
    matcher.match(frame, evidence);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(DisparityEvidence, RefusesOtherImagesThanGreyOnesOfItsSize) {
  StereoFrame frame = shifted(10);
  frame.right = frame.right.colRange(1, kSize.width);
  EXPECT_EQ(refusal(frame),
            "stereo: the right image is 199 x 90 of OpenCV's type 0, not 200 x 90 of type 0, grey of 8 bits");
  frame = shifted(10);
  frame.left.convertTo(frame.left, CV_16UC1);
  EXPECT_EQ(refusal(frame),
            "stereo: the left image is 200 x 90 of OpenCV's type 2, not 200 x 90 of type 0, grey of 8 bits");
  EXPECT_EQ(refusal({}), "stereo: the left image is 0 x 0 of OpenCV's type 0, not 200 x 90 of type 0, grey of 8 bits");
}

}  // namespace
}  // namespace flight_corridor
