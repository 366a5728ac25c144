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
Expected loopOver(const cv::Mat& depth_m, const cv::Rect& tiles) {
  Expected expected;
  for (int row = tiles.y; row < tiles.br().y; ++row) {
    for (int column = tiles.x; column < tiles.br().x; ++column) {
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

TEST(DepthPyramid, AgreesWithALoopOverThePixelsOfAnyRectangle) {
  std::mt19937 random(11);
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(61, 47), cv::Size(4, 4), cv::Size(3, 90)}) {
    const cv::Mat depth_m = randomDepth(size, random);
    DepthPyramid pyramid;
    pyramid.build(depth_m, kSmallGeometry, kBand_px, kRayFraction);
    const int columns = (size.width + kTile_px - 1) / kTile_px, rows = (size.height + kTile_px - 1) / kTile_px;
    const auto below = [&](int count) { return static_cast<int>(random() % static_cast<unsigned>(count)); };
    for (int trial = 0; trial < 800; ++trial) {
      cv::Rect tiles;
      tiles.x = below(columns);
      tiles.y = below(rows);
      tiles.width = 1 + below(columns - tiles.x);
      tiles.height = 1 + below(rows - tiles.y);
      const Expected expected = loopOver(depth_m, tiles);
      ASSERT_EQ(pyramid.nearest(tiles), expected.nearest_m);
      ASSERT_EQ(pyramid.farthest(tiles), expected.farthest_m);
      ASSERT_EQ(pyramid.unusable(tiles), expected.unusable);
    }
  }
}

}  // namespace
}  // namespace flight_corridor
