#include <gtest/gtest.h>

#include <cstdint>
#include <opencv2/core.hpp>

#include "flight_corridor/island_filter.hpp"

namespace flight_corridor {
namespace {

constexpr int kWall_px = 6, kThing_px = 17;
constexpr int kFixedPoint = 16;
constexpr std::int16_t kNone = -3 * kFixedPoint;
constexpr int kSpeckle_px = 100, kStep_px = 2;
const cv::Size kSize(160, 100);
const cv::Rect kSmall(60, 40, 12, 8), kMiddling(60, 40, 14, 12), kLarge(60, 40, 24, 20);

/// A wall of noise and, where thing says so, noise of its own before it.
struct Pair {
  cv::Mat left = cv::Mat(kSize, CV_8UC1), right = left.clone();

  explicit Pair(const cv::Rect& thing = {}) {
    cv::RNG(7).fill(left, cv::RNG::UNIFORM, 0, 256);
    cv::RNG(8).fill(right, cv::RNG::UNIFORM, 0, 256);
    left.colRange(kWall_px, left.cols).copyTo(right.colRange(0, left.cols - kWall_px));
    if (!thing.empty()) showThing(thing);
  }

  void showThing(const cv::Rect& thing) {
    cv::RNG(9).fill(right(thing - cv::Point(kWall_px, 0)), cv::RNG::UNIFORM, 0, 256);  // what it hides from the left
    left(thing).copyTo(right(thing - cv::Point(kThing_px, 0)));
  }
};

cv::Mat matches(double disparity_px) { return {kSize, CV_16SC1, cv::Scalar(disparity_px * kFixedPoint)}; }

/// The wall's matches, but others in a part of them.
cv::Mat wallWith(const cv::Rect& island, double island_px) {
  cv::Mat fixed = matches(kWall_px);
  fixed(island).setTo(island_px * kFixedPoint);
  return fixed;
}

/// What is left of an island; of the wall nothing may go.
int islandsPixelsLeft(const Pair& pair, const cv::Rect& island, double island_px, cv::Mat small = {}) {
  cv::Mat fixed = wallWith(island, island_px);
  IslandFilter(kSpeckle_px, kStep_px).filter(pair.left, pair.right, fixed, kNone, small);
  EXPECT_EQ(cv::countNonZero(fixed == kWall_px * kFixedPoint), kSize.area() - island.area()) << "the wall";
  const int left = cv::countNonZero(fixed(island) != kNone);
  EXPECT_EQ(cv::countNonZero(small), island.area() <= kSpeckle_px ? left : 0);
  return left;
}

TEST(IslandFilter, KeepsThings) {
  for (const cv::Rect& thing : {kSmall, kMiddling, kLarge}) {
    EXPECT_EQ(islandsPixelsLeft(Pair(thing), thing, kThing_px), thing.area()) << thing;
  }
}

TEST(IslandFilter, DropsMatchesThatFitOnTheWallAround) {
  for (const cv::Rect& mistake : {kSmall, kMiddling}) {
    EXPECT_EQ(islandsPixelsLeft(Pair(), mistake, kThing_px), 0) << mistake;
    EXPECT_EQ(islandsPixelsLeft(Pair(), mistake, kThing_px + 0.4), 0) << mistake;
  }
}

TEST(IslandFilter, TakesLargeOnesAtTheirWord) {
  EXPECT_EQ(islandsPixelsLeft(Pair(), kLarge, kThing_px), kLarge.area());
}

TEST(IslandFilter, DropsThemInTheGapsOfTheWallsMatchesToo) {
  const Pair pair;
  cv::Mat fixed = wallWith(kSmall + cv::Size(16, 16) - cv::Point(8, 8), -3.0), small;
  fixed(kSmall).setTo(kThing_px * kFixedPoint);
  IslandFilter(kSpeckle_px, kStep_px).filter(pair.left, pair.right, fixed, kNone, small);
  EXPECT_EQ(cv::countNonZero(fixed == kThing_px * kFixedPoint), 0);
}

TEST(IslandFilter, JudgesTouchingIslandsEachForItself) {
  const Pair pair(kSmall);
  cv::Mat fixed = wallWith(kSmall, kThing_px), small;
  const cv::Rect mistake = kSmall + cv::Point(0, kSmall.height);
  fixed(mistake).setTo(40 * kFixedPoint);
  IslandFilter(kSpeckle_px, kStep_px).filter(pair.left, pair.right, fixed, kNone, small);
  EXPECT_EQ(cv::countNonZero(fixed(kSmall) == kThing_px * kFixedPoint), kSmall.area());
  EXPECT_EQ(cv::countNonZero(fixed(mistake) == kNone), mistake.area());
}

TEST(IslandFilter, AThingOfLevelStripesFitsOnItselfAndStays) {
  Pair pair;
  const cv::Rect thing(60, 40, 24, 7);
  for (int v = thing.y; v < thing.br().y; ++v) {
    pair.left(cv::Rect(thing.x, v, thing.width, 1)).setTo(v % 3 == 0 ? 200 : 60);
  }
  pair.showThing(thing);
  EXPECT_EQ(islandsPixelsLeft(pair, thing, kThing_px), thing.area());
}

TEST(IslandFilter, ASpeckleThatIsNoThingGoesAndALargerPartOfALeaningSurfaceStays) {
  EXPECT_EQ(islandsPixelsLeft(Pair(), kSmall, kWall_px + 3.0), 0) << "hardly nearer";
  EXPECT_EQ(islandsPixelsLeft(Pair(), kSmall, 0.0), 0) << "farther";
  EXPECT_EQ(islandsPixelsLeft(Pair(), kMiddling, kWall_px + 3.0), kMiddling.area());
  const cv::Rect tiny(60, 40, 6, 6);
  EXPECT_EQ(islandsPixelsLeft(Pair(tiny), tiny, kThing_px), 0) << "fewer pixels than any thing";
}

TEST(IslandFilter, WithoutSurroundingsASpeckleGoesAndALargerIslandStays) {
  const Pair pair;
  for (const cv::Rect& island : {kSmall, kMiddling}) {
    cv::Mat fixed = matches(-3.0), small;
    fixed(island).setTo(kThing_px * kFixedPoint);
    IslandFilter(kSpeckle_px, kStep_px).filter(pair.left, pair.right, fixed, kNone, small);
    EXPECT_EQ(cv::countNonZero(fixed != kNone), island.area() > kSpeckle_px ? island.area() : 0) << island;
  }
}

TEST(IslandFilter, AnySizeOfSpecklesIsKeptTo) {
  const Pair pair;
  const auto left = [&](int speckle_px, const cv::Rect& island, double island_px) {
    cv::Mat fixed = wallWith(island, island_px), small;
    IslandFilter(speckle_px, kStep_px).filter(pair.left, pair.right, fixed, kNone, small);
    return cv::countNonZero(fixed(island) != kNone);
  };
  EXPECT_EQ(left(0, kSmall, kThing_px), kSmall.area()) << "off";
  EXPECT_EQ(left(kLarge.area(), kLarge, kWall_px + 3.0), 0) << "larger than other islands";
}

TEST(IslandFilter, WhatTheRightImageShowsOfAMistakeIsTheWalls) {
  Pair pair;
  cv::RNG(9).fill(pair.left(kMiddling), cv::RNG::UNIFORM, 0, 256);
  EXPECT_EQ(islandsPixelsLeft(pair, kMiddling, kThing_px), 0);
}

TEST(IslandFilter, OfWhatFitsNowhereASpeckleGoesAndALargerIslandStays) {
  Pair noise;
  cv::RNG(9).fill(noise.right, cv::RNG::UNIFORM, 0, 256);
  Pair grey;
  for (cv::Mat* image : {&grey.left, &grey.right}) image->setTo(90);
  for (const Pair& pair : {noise, grey}) {
    EXPECT_EQ(islandsPixelsLeft(pair, kSmall, kThing_px), 0);
    EXPECT_EQ(islandsPixelsLeft(pair, kMiddling, kThing_px), kMiddling.area());
  }
}

TEST(IslandFilter, AnyImageWillDo) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 2), cv::Size(40, 1), cv::Size(64, 48)}) {
    const cv::Mat image(size, CV_8UC1, cv::Scalar(90));
    for (const int disparity_px : {-3, -2, 0, 1, 1023}) {
      cv::Mat fixed(size, CV_16SC1, cv::Scalar(disparity_px * kFixedPoint)), small;
      IslandFilter(kSpeckle_px, kStep_px).filter(image, image, fixed, kNone, small);
      const bool stays = disparity_px != -3 && size.area() > kSpeckle_px;
      EXPECT_EQ(cv::countNonZero(fixed != kNone), stays ? size.area() : 0) << size << ' ' << disparity_px;
      EXPECT_EQ(small.size(), size);
    }
  }
}

}  // namespace
}  // namespace flight_corridor
