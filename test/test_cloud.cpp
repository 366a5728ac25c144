#include <gtest/gtest.h>

#include "flight_corridor/view/cloud.hpp"
#include "support/calibrations.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallGeometry;

TEST(Cloud, ACloudHoldsOnePointForEachVoxelOfAWall) {
  const cv::Mat left(kSmallGeometry.size(), CV_8UC1, cv::Scalar(77));
  const Cloud cloud = toCloud(test_support::wallDepth(kSmallGeometry.size(), 4.05), left, kSmallGeometry, {}, 0.1);
  const double width_m = 4.05 * 320 / 175, height_m = 4.05 * 240 / 175;
  EXPECT_NEAR(cloud.size(), width_m * height_m / 0.01, 0.05 * cloud.size());  // cells cut by the image's border
  for (const auto& point : cloud) {
    EXPECT_NEAR(point.z, 4.05f, 1e-4);
    EXPECT_NEAR(point.intensity, 77.0f, 1e-3);
  }
}

TEST(Cloud, LonePixelsAreNoise) {
  cv::Mat depth(kSmallGeometry.size(), CV_32FC1, cv::Scalar(kNaN));
  depth.at<float>(50, 50) = 2.0f;
  depth.at<float>(50, 51) = 2.0f;
  const Cloud cloud = toCloud(depth, cv::Mat(kSmallGeometry.size(), CV_8UC1, cv::Scalar(0)), kSmallGeometry, {}, 0.1);
  EXPECT_TRUE(cloud.empty());
}

TEST(Cloud, NothingBeyondTheRangeIsKept) {
  const Cloud cloud = toCloud(test_support::wallDepth(kSmallGeometry.size(), 8.1),
                              cv::Mat(kSmallGeometry.size(), CV_8UC1), kSmallGeometry, {}, 0.1);
  EXPECT_TRUE(cloud.empty());
}

}  // namespace
}  // namespace flight_corridor
