#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>

#include "flight_corridor/map/depth_pyramid.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallGeometry;

constexpr int kTile_px = DepthPyramid::kTile_px;
constexpr double kBand_px = 0.5, kRayFraction = 0.7;

struct Expected {
  float nearest_m = INFINITY, farthest_m = 0.0f;
  int unusable = 0;
};

/// Pixel by pixel.
Expected loopOver(const cv::Mat& depth_m, const DepthPyramid::Tiles& tiles) {
  Expected expected;
  for (int row = tiles.top; row <= tiles.bottom; ++row) {
    for (int column = tiles.left; column <= tiles.right; ++column) {
      const cv::Rect area =
          cv::Rect(column * kTile_px, row * kTile_px, kTile_px, kTile_px) & cv::Rect({0, 0}, depth_m.size());
      float nearest_m = INFINITY;
      int rays = 0;
      for (int v = area.y; v < area.br().y; ++v) {
        for (int u = area.x; u < area.br().x; ++u) {
          const float surface_m = depth_m.at<float>(v, u);
          if (std::isnan(surface_m)) continue;
          nearest_m = std::min(nearest_m, kSmallGeometry.shiftedDepth(surface_m, kBand_px));
          ++rays;
        }
      }
      expected.nearest_m = std::min(expected.nearest_m, nearest_m);
      if (rays > 0) expected.farthest_m = std::max(expected.farthest_m, nearest_m);
      expected.unusable += rays < kRayFraction * area.area();
    }
  }
  return expected;
}

cv::Mat randomDepth(cv::Size size, std::mt19937& random) {
  std::uniform_real_distribution<float> depth(0.5f, 9.0f);
  cv::Mat depth_m(size, CV_32FC1);
  for (int i = 0; i < size.area(); ++i) depth_m.ptr<float>()[i] = random() % 4 ? depth(random) : NAN;
  depth_m.rowRange(0, std::min(5, size.height)).setTo(NAN);  // tiles without any ray
  depth_m.at<float>(size.height - 1, size.width - 1) = INFINITY;
  return depth_m;
}

TEST(DepthPyramid, AgreesWithALoopOverThePixelsOfAnyRectangleAloneOrAmongEight) {
  std::mt19937 random(11);
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(61, 47), cv::Size(4, 4), cv::Size(3, 90)}) {
    const cv::Mat depth_m = randomDepth(size, random);
    DepthPyramid pyramid;
    pyramid.build(depth_m, kSmallGeometry, kBand_px, kRayFraction);
    const int columns = (size.width + kTile_px - 1) / kTile_px, rows = (size.height + kTile_px - 1) / kTile_px;
    for (int trial = 0; trial < 100; ++trial) {
      DepthPyramid::EightTiles tiles;
      for (int i = 0; i < 8; ++i) {
        tiles.left[i] = random() % columns;
        tiles.top[i] = random() % rows;
        tiles.right[i] = tiles.left[i] + random() % std::min(trial % 2 ? columns : 8, columns - tiles.left[i]);
        tiles.bottom[i] = tiles.top[i] + random() % std::min(trial % 2 ? rows : 8, rows - tiles.top[i]);
      }
      float nearest_m[8];
      int unusable[8];
      pyramid.nearest(tiles, nearest_m);
      pyramid.unusable(tiles, unusable);
      for (unsigned i = 0; i < 8; ++i) {
        const Expected expected = loopOver(depth_m, tiles[i]);
        ASSERT_EQ(nearest_m[i], expected.nearest_m);
        ASSERT_EQ(pyramid.nearest(tiles[i]), expected.nearest_m);
        ASSERT_EQ(pyramid.farthest(tiles[i], 1), expected.farthest_m);
        ASSERT_EQ(unusable[i], expected.unusable);
      }
    }
  }
}

TEST(DepthPyramid, NoRectangleOfAsManyTilesIsFreeBeyondTheFarthest) {
  std::mt19937 random(12);
  const cv::Mat depth_m = randomDepth({64, 48}, random);
  DepthPyramid pyramid;
  pyramid.build(depth_m, kSmallGeometry, kBand_px, kRayFraction);
  int below_the_most_of_single_tiles = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const int left = random() % 15, top = random() % 11;
    const DepthPyramid::Tiles tiles{left, top, left + 1 + static_cast<int>(random() % (15 - left)),
                                    top + 1 + static_cast<int>(random() % (11 - top))};
    const float farthest_m = pyramid.farthest(tiles, 2);
    for (int row = tiles.top; row < tiles.bottom; ++row) {
      for (int column = tiles.left; column < tiles.right; ++column) {
        const Expected within = loopOver(depth_m, {column, row, column + 1, row + 1});
        const bool holds_a_ray = within.farthest_m > 0.0f;
        ASSERT_TRUE(!holds_a_ray || within.nearest_m <= farthest_m) << within.nearest_m << " " << farthest_m;
      }
    }
    below_the_most_of_single_tiles += farthest_m < pyramid.farthest(tiles, 1);
  }
  EXPECT_GT(below_the_most_of_single_tiles, 100);
}

}  // namespace
}  // namespace flight_corridor
