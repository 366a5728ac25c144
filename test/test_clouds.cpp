#include <gtest/gtest.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl_conversions/pcl_conversions.h>

#include <cmath>

#include "ros/clouds.hpp"
#include "support/calibrations.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::MapConfig;
using flight_corridor::test_support::kVgaGeometry;
using flight_corridor::test_support::wallDepth;
using Points = pcl::PointCloud<pcl::PointXYZ>;

Points read(const sensor_msgs::PointCloud2& message) {
  Points points;
  if (message.data.empty()) return points;  // PCL would take the address of the first of no points
  pcl::fromROSMsg(message, points);
  return points;
}

Points clearing(const cv::Mat& depth_m) { return read(toClearing({}, depth_m, kVgaGeometry, MapConfig())); }

TEST(ToObstacles, AreTheOccupiedCellsInTheCamerasFrame) {
  octomap::OcTree tree(0.1);
  tree.updateNode(octomap::point3d(2.05f, 0.05f, 1.55f), 2.0f);
  tree.updateNode(octomap::point3d(3.05f, 0.05f, 1.55f), -0.7f);
  tree.updateNode(octomap::point3d(9.05f, 0.05f, 1.55f), 2.0f);  // too far
  const Eigen::Isometry3d T_M_C =
      Eigen::Translation3d(0.05, 0.05, 1.55) * flight_corridor::opticalFromForward().inverse();
  std_msgs::Header header;
  header.frame_id = "left_optical";
  const auto message = toObstacles(header, tree, T_M_C, 8.0);
  EXPECT_EQ(message.header.frame_id, "left_optical");
  const Points points = read(message);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_TRUE(points[0].getVector3fMap().isApprox(Eigen::Vector3f(0, 0, 2), 1e-5f));
}

TEST(ToObstacles, LargeLeavesAreTheirCells) {
  octomap::OcTree tree(0.1);
  for (int cell = 0; cell < 8; ++cell) {
    tree.updateNode(
        octomap::point3d(0.05f + 0.1f * (cell & 1), 0.05f + 0.1f * (cell >> 1 & 1), 0.05f + 0.1f * (cell >> 2)), 10.0f);
  }
  ASSERT_EQ(tree.getNumLeafNodes(), 1u);
  Eigen::AlignedBox3f box;
  const Points points = read(toObstacles({}, tree, Eigen::Isometry3d::Identity(), 8.0));
  for (const auto& point : points) box.extend(point.getVector3fMap());
  EXPECT_EQ(points.size(), 8u);
  EXPECT_TRUE(box.min().isApproxToConstant(0.05f, 1e-4f));
  EXPECT_TRUE(box.max().isApproxToConstant(0.15f, 1e-4f));
}

TEST(ToObstacles, AnEmptyMapIsAnEmptyCloud) {
  EXPECT_EQ(toObstacles({}, octomap::OcTree(0.1), Eigen::Isometry3d::Identity(), 8.0).width, 0u);
}

TEST(ToClearing, RaysEndBeforeTheWallAllOverTheImage) {
  const Points points = clearing(wallDepth({640, 480}, 4.0));
  EXPECT_EQ(points.size(), 80u * 60u);
  // Half a pixel of disparity before 4 m: 42 / (42 / 4 + 0.5).
  for (const auto& point : points) EXPECT_NEAR(point.z, 42.0 / 11.0, 1e-4);
  EXPECT_NEAR(points.front().x, (3.5 - 319.5) / 350.0 * 42.0 / 11.0, 1e-3);
}

TEST(ToClearing, FarRaysEndAtTheMapsRange) {
  for (const auto& point : clearing(wallDepth({640, 480}, 30.0))) EXPECT_NEAR(point.z, MapConfig().max_range_m, 1e-4);
}

TEST(ToClearing, APoleEndsTheRaysOfItsTiles) {
  cv::Mat depth_m = wallDepth({640, 480}, 6.0);
  depth_m.colRange(322, 324) = 2.0;  // two pixels of the tile 320..327
  int short_rays = 0;
  for (const auto& point : clearing(depth_m)) short_rays += point.z < 2.0f;
  EXPECT_EQ(short_rays, 60);
}

TEST(ToClearing, WhereTooFewPixelsHaveADepthThereIsNoRay) {
  cv::Mat depth_m = wallDepth({640, 480}, 6.0);
  depth_m.rowRange(0, 240) = NAN;
  EXPECT_EQ(clearing(depth_m).size(), 80u * 30u);
  EXPECT_TRUE(clearing(wallDepth({640, 480}, NAN)).empty());
}

}  // namespace
}  // namespace flight_corridor_ros
