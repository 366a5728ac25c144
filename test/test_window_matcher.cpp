#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "flight_corridor/stereo/window_matcher.hpp"

namespace flight_corridor {
namespace {

constexpr int kShift_px = 9;
constexpr int kU = 60, kV = 20;

/// Noise, shifted by one disparity; the right image is darker and of less contrast.
struct Pair {
  cv::Mat left = cv::Mat(40, 100, CV_8UC1), right = left.clone();

  Pair() {
    cv::RNG(7).fill(left, cv::RNG::UNIFORM, 0, 256);
    cv::RNG(8).fill(right, cv::RNG::UNIFORM, 0, 256);
    const int width = left.cols - kShift_px;
    left.colRange(kShift_px, left.cols).convertTo(right.colRange(0, width), -1, 0.5, 30.0);
  }
};

/// The best correlation of a range; -1 where there is none.
float best(const WindowMatcher& matcher, int u, int v, int first_px, int last_px) {
  std::vector<float> correlations;
  matcher.correlations(u, v, first_px, last_px, correlations);
  return correlations.empty() ? -1.0f : *std::max_element(correlations.begin(), correlations.end());
}

bool fits(int u, int v, int first_px, int last_px, cv::Range rows = {0, 40}) {
  const Pair pair;
  return best(WindowMatcher(pair.left, pair.right, rows), u, v, first_px, last_px) >= 0.85f;
}

TEST(WindowMatcher, FitsAtItsDisparityAloneWhateverTheExposures) {
  for (int disparity_px = 0; disparity_px < 40; ++disparity_px) {
    EXPECT_EQ(fits(kU, kV, disparity_px, disparity_px), disparity_px == kShift_px) << disparity_px;
  }
}

TEST(WindowMatcher, LooksAtBothEndsOfTheRange) {
  EXPECT_TRUE(fits(kU, kV, kShift_px, kShift_px + 5));
  EXPECT_TRUE(fits(kU, kV, kShift_px - 5, kShift_px));
  EXPECT_FALSE(fits(kU, kV, kShift_px + 1, kShift_px + 5));
  EXPECT_FALSE(fits(kU, kV, kShift_px + 1, kShift_px - 1)) << "an empty range";
}

TEST(WindowMatcher, GivesTheBestCorrelationOfTheRange) {
  const Pair pair;
  const WindowMatcher matcher(pair.left, pair.right, {0, 40});
  EXPECT_NEAR(best(matcher, kU, kV, kShift_px, kShift_px), 1.0, 0.01);
  EXPECT_EQ(best(matcher, kU, kV, 0, 40), best(matcher, kU, kV, kShift_px, kShift_px));
  EXPECT_LT(std::abs(best(matcher, kU, kV, 3, 3)), 0.6) << "noise on other noise";
  EXPECT_EQ(best(matcher, 99, kV, 0, 40), -1.0f) << "not whole";
}

TEST(WindowMatcher, GivesTheCorrelationOfEachDisparityWhoseWindowsAreWhole) {
  const Pair pair;
  constexpr int kReach_px = WindowMatcher::kReach_px;
  const WindowMatcher matcher(pair.left, pair.right, {0, 40});
  std::vector<float> correlations;
  EXPECT_EQ(matcher.correlations(kU, kV, 3, 20, correlations), 20);
  ASSERT_EQ(correlations.size(), 18u);
  for (int px = 3; px <= 20; ++px) {
    EXPECT_EQ(correlations[20 - px], best(matcher, kU, kV, px, px)) << px;
    EXPECT_EQ(correlations[20 - px] > 0.85f, px == kShift_px) << px;
  }
  EXPECT_EQ(matcher.correlations(kU, kV, -200, 200, correlations), kU - kReach_px);
  EXPECT_EQ(correlations.size(), 100u - 2 * kReach_px);
  matcher.correlations(kReach_px - 1, kV, 0, 40, correlations);
  EXPECT_TRUE(correlations.empty()) << "not whole on the left image";
}

TEST(WindowMatcher, IsTheSameForSomeOfTheRows) {
  EXPECT_TRUE(fits(kU, kV, kShift_px, kShift_px, {kV, kV + 1}));
  EXPECT_FALSE(fits(kU, kV, kShift_px + 1, kShift_px + 9, {kV, kV + 1}));
}

TEST(WindowMatcher, NothingFitsWhereTheWindowIsNotWholeOnBothImages) {
  EXPECT_TRUE(fits(kShift_px + 2, 2, kShift_px, kShift_px));
  EXPECT_FALSE(fits(kShift_px + 1, 2, kShift_px, kShift_px)) << "beside the right image";
  EXPECT_FALSE(fits(99, kV, kShift_px, kShift_px)) << "beside the left one";
  EXPECT_FALSE(fits(kU, 1, kShift_px, kShift_px)) << "above";
  EXPECT_FALSE(fits(kU, 38, kShift_px, kShift_px)) << "below";
  EXPECT_FALSE(fits(kU, kV, -1000, -500));
  EXPECT_FALSE(fits(kU, kV, 500, 1000));
}

TEST(WindowMatcher, WithoutTextureNothingFits) {
  const cv::Mat grey(40, 100, CV_8UC1, cv::Scalar(90));
  EXPECT_LT(best(WindowMatcher(grey, grey, {0, 40}), kU, kV, 0, 40), 0.85f);
}

}  // namespace
}  // namespace flight_corridor
