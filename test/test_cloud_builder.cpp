#include <gtest/gtest.h>

#include <cmath>

#include "flight_corridor/cloud_builder.hpp"
#include "support/calibrations.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

const StereoGeometry kGeometry(test_support::smallCalibration());

TEST(CloudBuilder, DepthIsOfTheCorrectedDisparity) {
  ScaleCorrection scale((ScaleConfig()));
  for (int i = 0; i < 50; ++i) scale.update(i, 10.0, 10.5, 0.05, 0.0);
  cv::Mat disparity_px(kGeometry.size(), CV_32FC1, cv::Scalar(10.0)), depth_m;
  disparity_px.at<float>(1, 1) = static_cast<float>(kNaN);
  CloudBuilder(CloudConfig(), kGeometry).depth(disparity_px, scale, depth_m);
  EXPECT_NEAR(depth_m.at<float>(100, 100), kGeometry.depth(scale.correct(10.0)), 1e-6);
  EXPECT_LT(depth_m.at<float>(100, 100), kGeometry.depth(10.2));
  EXPECT_TRUE(std::isnan(depth_m.at<float>(1, 1)));
}

TEST(CloudBuilder, ACloudHoldsOnePointForEachVoxelOfAWall) {
  CloudBuilder builder(CloudConfig(), kGeometry);
  const cv::Mat left(kGeometry.size(), CV_8UC1, cv::Scalar(77));
  Cloud cloud;
  builder.cloud(test_support::wallDepth(kGeometry.size(), 4.05), left, 0.1, cloud);
  const double width_m = 4.05 * 320 / 175, height_m = 4.05 * 240 / 175;
  EXPECT_NEAR(cloud.size(), width_m * height_m / 0.01, 0.05 * cloud.size());  // cells cut by the image's border
  for (const auto& point : cloud) {
    EXPECT_NEAR(point.z, 4.05f, 1e-4);
    EXPECT_NEAR(point.intensity, 77.0f, 1e-3);
  }
}

TEST(CloudBuilder, LonePixelsAreNoise) {
  CloudBuilder builder(CloudConfig(), kGeometry);
  cv::Mat depth(kGeometry.size(), CV_32FC1, cv::Scalar(kNaN));
  depth.at<float>(50, 50) = 2.0f;
  depth.at<float>(50, 51) = 2.0f;
  Cloud cloud;
  builder.cloud(depth, cv::Mat(kGeometry.size(), CV_8UC1, cv::Scalar(0)), 0.1, cloud);
  EXPECT_TRUE(cloud.empty());
}

TEST(CloudBuilder, NothingBeyondTheRangeIsKept) {
  CloudBuilder builder(CloudConfig(), kGeometry);
  Cloud cloud;
  builder.cloud(test_support::wallDepth(kGeometry.size(), 8.1), cv::Mat(kGeometry.size(), CV_8UC1), 0.1, cloud);
  EXPECT_TRUE(cloud.empty());
}

}  // namespace
}  // namespace flight_corridor
