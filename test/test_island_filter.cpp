#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "flight_corridor/island_filter.hpp"

namespace flight_corridor {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr int kWall_px = 6, kThing_px = 17;
const cv::Rect kSmall(60, 40, 12, 8), kLarge(60, 40, 24, 20);

/// A wall of noise and, where thing says so, noise of its own before it.
struct Pair {
  cv::Mat left = cv::Mat(100, 160, CV_8UC1), right = left.clone();

  explicit Pair(const cv::Rect& thing = {}) {
    cv::RNG(7).fill(left, cv::RNG::UNIFORM, 0, 256);
    cv::RNG(8).fill(right, cv::RNG::UNIFORM, 0, 256);
    left.colRange(kWall_px, left.cols).copyTo(right.colRange(0, left.cols - kWall_px));
    if (thing.empty()) return;
    cv::RNG(9).fill(right(thing - cv::Point(kWall_px, 0)), cv::RNG::UNIFORM, 0, 256);  // what it hides from the left
    left(thing).copyTo(right(thing - cv::Point(kThing_px, 0)));
  }
};

/// The wall's matches, but island_px in a part of them.
cv::Mat wallWith(const cv::Rect& island, float island_px) {
  cv::Mat disparity_px(100, 160, CV_32FC1, cv::Scalar(kWall_px));
  disparity_px(island).setTo(island_px);
  return disparity_px;
}

int islandsPixelsLeft(const Pair& pair, const cv::Rect& island, float island_px) {
  cv::Mat disparity_px = wallWith(island, island_px);
  IslandFilter().filter(pair.left, pair.right, disparity_px);
  EXPECT_EQ(cv::countNonZero(disparity_px == kWall_px), disparity_px.size().area() - island.area()) << "the wall";
  return cv::countNonZero(disparity_px(island) == island_px);
}

TEST(IslandFilter, KeepsASmallThing) { EXPECT_EQ(islandsPixelsLeft(Pair(kSmall), kSmall, kThing_px), kSmall.area()); }

TEST(IslandFilter, DropsMatchesThatFitOnTheWallAround) {
  EXPECT_EQ(islandsPixelsLeft(Pair(), kSmall, kThing_px), 0);
  EXPECT_EQ(islandsPixelsLeft(Pair(), kSmall, kThing_px + 0.4f), 0);
}

TEST(IslandFilter, DropsThemInTheGapsOfTheWallsMatchesToo) {
  const Pair pair;
  cv::Mat disparity_px = wallWith(kSmall + cv::Size(16, 16) - cv::Point(8, 8), kNothing);
  disparity_px(kSmall).setTo(kThing_px);
  IslandFilter().filter(pair.left, pair.right, disparity_px);
  EXPECT_EQ(cv::countNonZero(disparity_px == kThing_px), 0);
}

TEST(IslandFilter, TakesLargeOnesAtTheirWord) {
  EXPECT_EQ(islandsPixelsLeft(Pair(), kLarge, kThing_px), kLarge.area());
}

TEST(IslandFilter, APartOfASurfaceThatLeansStays) {
  EXPECT_EQ(islandsPixelsLeft(Pair(), kSmall, kWall_px + 3.0f), kSmall.area());
}

TEST(IslandFilter, WithoutTextureAndWithoutSurroundingsIslandsStay) {
  const cv::Mat grey(100, 160, CV_8UC1, cv::Scalar(90));
  cv::Mat disparity_px = wallWith(kSmall, kThing_px);
  IslandFilter().filter(grey, grey, disparity_px);
  EXPECT_EQ(cv::countNonZero(disparity_px == kThing_px), kSmall.area());

  const Pair pair;
  cv::Mat alone(100, 160, CV_32FC1, cv::Scalar(kNothing));
  alone(kSmall).setTo(kThing_px);
  IslandFilter().filter(pair.left, pair.right, alone);
  EXPECT_EQ(cv::countNonZero(alone == kThing_px), kSmall.area());
}

TEST(IslandFilter, AnyImageWillDo) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 2), cv::Size(40, 1)}) {
    const cv::Mat image(size, CV_8UC1, cv::Scalar(90));
    for (const float matched_px : {kNothing, 1.0f, -2.0f, 1023.0f}) {
      cv::Mat disparity_px(size, CV_32FC1, cv::Scalar(matched_px));
      IslandFilter().filter(image, image, disparity_px);
      const int expected = std::isnan(matched_px) ? 0 : size.area();
      EXPECT_EQ(cv::countNonZero(disparity_px == disparity_px), expected) << size << ' ' << matched_px;
    }
  }
}

}  // namespace
}  // namespace flight_corridor
