#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>

#include "flight_corridor/depth_pyramid.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {
namespace {

TEST(DepthPyramid, AgreesWithALoopOverTheTilesOfAnyRectangle) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> depth(0.5f, 9.0f);
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(61, 47), cv::Size(4, 4), cv::Size(3, 90)}) {
    cv::Mat near(size, CV_32FC1), far(size, CV_32FC1);
    for (int i = 0; i < size.area(); ++i) {
      const bool ray = random() % 4 != 0;
      near.ptr<float>()[i] = ray ? depth(random) : static_cast<float>(kNaN);
      far.ptr<float>()[i] = near.ptr<float>()[i] + 0.3f;
    }
    DepthPyramid pyramid;
    pyramid.build(near, far, 0.7);
    for (int trial = 0; trial < 300; ++trial) {
      const int x = random() % size.width, y = random() % size.height;
      const cv::Rect rectangle(x, y, 1 + random() % (size.width - x), 1 + random() % (size.height - y));
      const int tile = DepthPyramid::kTile_px;
      float nearest = INFINITY, farthest = 0.0f;
      int usable = 0, tiles = 0;
      for (int ty = y / tile; ty <= (rectangle.br().y - 1) / tile; ++ty) {
        for (int tx = x / tile; tx <= (rectangle.br().x - 1) / tile; ++tx, ++tiles) {
          const cv::Rect area = cv::Rect(tx * tile, ty * tile, tile, tile) & cv::Rect({0, 0}, size);
          int rays = 0;
          for (int v = area.y; v < area.br().y; ++v) {
            for (int u = area.x; u < area.br().x; ++u) {
              if (std::isnan(near.at<float>(v, u))) continue;
              nearest = std::min(nearest, near.at<float>(v, u));
              farthest = std::max(farthest, far.at<float>(v, u));
              ++rays;
            }
          }
          usable += rays >= 0.7 * area.area();
        }
      }
      const DepthPyramid::Reach reach = pyramid.reach(rectangle);
      ASSERT_EQ(reach.nearest_m, nearest) << rectangle;
      ASSERT_EQ(reach.farthest_m, farthest) << rectangle;
      ASSERT_FLOAT_EQ(reach.tile_fraction, usable / static_cast<float>(tiles)) << rectangle;
    }
  }
}

}  // namespace
}  // namespace flight_corridor
