#include <gtest/gtest.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <sstream>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"
#include "ros/map_conversions.hpp"
#include "support/header.hpp"

namespace flight_corridor_ros {
namespace {

using test_support::header;

octomap_msgs::BoundingBoxQueryRequest boxRequest(double min, double max) {
  octomap_msgs::BoundingBoxQueryRequest request;
  request.min.x = request.min.y = request.min.z = min;
  request.max.x = request.max.y = request.max.z = max;
  return request;
}

TEST(ToBox, HoldsBothCorners) {
  octomap_msgs::BoundingBoxQueryRequest request = boxRequest(-1.0, 2.0);
  request.max.z = 3.0;
  const Eigen::AlignedBox3d box = toBox(request);
  EXPECT_EQ(box.min(), Eigen::Vector3d(-1.0, -1.0, -1.0));
  EXPECT_EQ(box.max(), Eigen::Vector3d(2.0, 2.0, 3.0));
}

TEST(ToBox, RefusesCornersThatAreSwappedOrNotFinite) {
  EXPECT_THROW(toBox(boxRequest(2.0, -1.0)), std::invalid_argument);
  EXPECT_THROW(toBox(boxRequest(flight_corridor::kNaN, 1.0)), std::invalid_argument);
  EXPECT_THROW(toBox(boxRequest(0.0, flight_corridor::kInfinity)), std::invalid_argument);
}

class MapConversions : public testing::Test {
 protected:
  MapConversions() {
    tree.updateNode(octomap::point3d(1.05f, 0.05f, 0.05f), 2.0f);
    tree.updateNode(octomap::point3d(1.05f, 0.05f, 0.25f), -0.7f);
    tree.updateNode(octomap::point3d(1.25f, -0.15f, 0.05f), -0.7f);
    tree.updateNode(octomap::point3d(1.05f, 0.05f, 0.55f), 2.0f);
  }

  static std::size_t cubes(const visualization_msgs::MarkerArray& array) {
    std::size_t count = 0;
    for (const auto& marker : array.markers) count += marker.points.size();
    return count;
  }

  octomap::OcTree tree{0.1};
};

TEST_F(MapConversions, OctomapsCanBeReadBack) {
  const auto binary = toBinaryOctomap(header("odom"), tree);
  const auto full = toFullOctomap(header("odom"), tree);
  octomap::OcTree from_binary(binary.resolution), from_full(full.resolution);
  std::stringstream binary_data(std::string(binary.data.begin(), binary.data.end()));
  std::stringstream full_data(std::string(full.data.begin(), full.data.end()));
  from_binary.readBinaryData(binary_data);
  from_full.readData(full_data);
  EXPECT_TRUE(from_full == tree);
  EXPECT_EQ(from_binary.getNumLeafNodes(), tree.getNumLeafNodes());
  EXPECT_TRUE(from_binary.isNodeOccupied(from_binary.search(1.05, 0.05, 0.05)));
  EXPECT_FALSE(from_binary.isNodeOccupied(from_binary.search(1.05, 0.05, 0.25)));
  EXPECT_TRUE(binary.binary);
  EXPECT_FALSE(full.binary);
  EXPECT_EQ(binary.id, "OcTree");
  EXPECT_EQ(binary.header.frame_id, "odom");
}

TEST_F(MapConversions, AnEmptyTreeIsAnEmptyOctomap) {
  const octomap::OcTree empty(0.1);
  EXPECT_TRUE(toBinaryOctomap(header("odom"), empty).data.empty());
  EXPECT_TRUE(toProjectedMap(header("odom"), empty).data.empty());
  EXPECT_EQ(toCellCentres(header("odom"), empty).width, 0u);
}

TEST_F(MapConversions, MarkersHoldEachLeafOnceAtItsSize) {
  const auto occupied = toMarkers(header("odom"), tree, Cells::Occupied, Eigen::Isometry3d::Identity());
  const auto free = toMarkers(header("odom"), tree, Cells::Free, Eigen::Isometry3d::Identity());
  ASSERT_EQ(occupied.markers.size(), tree.getTreeDepth() + 1);
  EXPECT_EQ(cubes(occupied), 2u);
  EXPECT_EQ(cubes(free), 2u);
  const auto& smallest = occupied.markers.back();
  EXPECT_EQ(smallest.points.size(), 2u);
  EXPECT_EQ(smallest.colors.size(), 2u);
  EXPECT_NEAR(smallest.scale.x, 0.1, 1e-9);
  EXPECT_EQ(smallest.action, visualization_msgs::Marker::ADD);
  EXPECT_EQ(occupied.markers.front().action, visualization_msgs::Marker::DELETE);
  EXPECT_NEAR(occupied.markers.front().scale.x, tree.getNodeSize(0), 1e-6);
  EXPECT_EQ(smallest.id, static_cast<int>(tree.getTreeDepth()));
}

TEST_F(MapConversions, LowCellsAreBlueAndHighOnesRed) {
  const auto markers = toMarkers(header("odom"), tree, Cells::Occupied, Eigen::Isometry3d::Identity());
  const auto& cells = markers.markers.back();
  for (std::size_t i = 0; i < cells.points.size(); ++i) {
    EXPECT_EQ(cells.points[i].z<0.3, cells.colors[i].b> cells.colors[i].r) << cells.points[i].z;
  }
}

TEST_F(MapConversions, CentresAreThoseOfTheOccupiedCells) {
  const auto cloud = toCellCentres(header("odom"), tree);
  ASSERT_EQ(cloud.width * cloud.height, 2u);
  for (sensor_msgs::PointCloud2ConstIterator<float> x(cloud, "x"); x != x.end(); ++x) EXPECT_NEAR(*x, 1.05, 1e-6);
}

TEST_F(MapConversions, ProjectedMapTellsOccupiedFreeAndUnknownColumns) {
  const auto grid = toProjectedMap(header("odom"), tree);
  ASSERT_EQ(grid.info.width, 3u);   // x 1.0 to 1.3
  ASSERT_EQ(grid.info.height, 3u);  // y -0.2 to 0.1
  EXPECT_NEAR(grid.info.origin.position.x, 1.0, 1e-6);
  EXPECT_NEAR(grid.info.origin.position.y, -0.2, 1e-6);
  EXPECT_EQ(grid.data[2 * 3 + 0], 100);
  EXPECT_EQ(grid.data[0 * 3 + 2], 0);
  EXPECT_EQ(grid.data[1 * 3 + 1], -1);
}

TEST_F(MapConversions, LargeLeavesFillTheirWholeSquare) {
  octomap::OcTree pruned(0.1);
  for (float x : {0.05f, 0.15f}) {
    for (float y : {0.05f, 0.15f}) {
      for (float z : {0.05f, 0.15f}) pruned.updateNode(octomap::point3d(x, y, z), 10.0f);
    }
  }
  ASSERT_EQ(pruned.getNumLeafNodes(), 1u);
  EXPECT_EQ(toProjectedMap(header("odom"), pruned).data, std::vector<std::int8_t>(4, 100));
}

}  // namespace
}  // namespace flight_corridor_ros
