#include "ros/map_conversions.hpp"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl_conversions/pcl_conversions.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace flight_corridor_ros {

namespace {

using visualization_msgs::Marker;

constexpr std::int8_t kGridUnknown = -1, kGridFree = 0, kGridOccupied = 100;

template <typename Write>
octomap_msgs::Octomap toOctomap(const std_msgs::Header& header, const octomap::OcTree& tree, bool binary, Write write) {
  std::stringstream stream;
  write(stream);
  const std::string data = stream.str();
  octomap_msgs::Octomap message;
  message.header = header;
  message.binary = binary;
  message.id = tree.getTreeType();
  message.resolution = tree.getResolution();
  message.data.assign(data.begin(), data.end());
  return message;
}

Eigen::Vector3d centreOf(const octomap::OcTree::leaf_iterator& leaf) { return {leaf.getX(), leaf.getY(), leaf.getZ()}; }

/// Blue at 0 over green to red at 1.
std_msgs::ColorRGBA heightColour(double share) {
  const auto band = [share](double centre) {
    return static_cast<float>(std::clamp(1.5 - std::abs(4.0 * share - centre), 0.0, 1.0));
  };
  std_msgs::ColorRGBA colour;
  colour.r = band(3.0);
  colour.g = band(2.0);
  colour.b = band(1.0);
  colour.a = 0.3f;  // the cloud lies within the cells
  return colour;
}

std_msgs::ColorRGBA freeColour() {
  std_msgs::ColorRGBA colour;
  colour.g = 1.0f;
  colour.a = 0.1f;
  return colour;
}

Marker emptyCubes(const std_msgs::Header& header, unsigned depth, double edge_m) {
  Marker marker;
  marker.header = header;
  marker.ns = "map";
  marker.id = static_cast<int>(depth);
  marker.type = Marker::CUBE_LIST;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = edge_m;
  return marker;
}

void colourByHeight(visualization_msgs::MarkerArray& array, const Eigen::Isometry3d& T_M_G) {
  const Eigen::Vector3d up_M = T_M_G.linear().col(2);
  const auto height = [&up_M](const geometry_msgs::Point& p) { return up_M.dot(Eigen::Vector3d(p.x, p.y, p.z)); };
  double lowest = INFINITY, highest = -INFINITY;
  for (const Marker& marker : array.markers) {
    for (const auto& point : marker.points) {
      lowest = std::min(lowest, height(point));
      highest = std::max(highest, height(point));
    }
  }
  const double span = std::max(highest - lowest, 1e-3);  // all at one height: the low end's colour
  for (Marker& marker : array.markers) {
    for (const auto& point : marker.points) marker.colors.push_back(heightColour((height(point) - lowest) / span));
  }
}

/// A leaf's square on the ground.
Eigen::AlignedBox2d footprint(const octomap::OcTree::leaf_iterator& leaf) {
  const Eigen::Vector2d centre = centreOf(leaf).head<2>();
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(leaf.getSize() / 2);
  return {centre - half, centre + half};
}

void fill(nav_msgs::OccupancyGrid& grid, const Eigen::Vector2i& first, int count, std::int8_t value) {
  for (int y = first.y(); y < first.y() + count; ++y) {
    for (int x = first.x(); x < first.x() + count; ++x) {
      std::int8_t& cell = grid.data[static_cast<std::size_t>(y) * grid.info.width + static_cast<std::size_t>(x)];
      cell = std::max(cell, value);
    }
  }
}

}  // namespace

Eigen::AlignedBox3d toBox(const octomap_msgs::BoundingBoxQueryRequest& request) {
  Eigen::Vector3d min, max;
  tf2::fromMsg(request.min, min);
  tf2::fromMsg(request.max, max);
  const bool sane = min.allFinite() && max.allFinite() && (min.array() <= max.array()).all();
  if (!sane) throw std::invalid_argument("box: min and max must be finite, and max nowhere below min");
  return {min, max};
}

octomap_msgs::Octomap toBinaryOctomap(const std_msgs::Header& header, const octomap::OcTree& tree) {
  return toOctomap(header, tree, true, [&tree](std::ostream& stream) { tree.writeBinaryData(stream); });
}

octomap_msgs::Octomap toFullOctomap(const std_msgs::Header& header, const octomap::OcTree& tree) {
  return toOctomap(header, tree, false, [&tree](std::ostream& stream) { tree.writeData(stream); });
}

visualization_msgs::MarkerArray toMarkers(const std_msgs::Header& header, const octomap::OcTree& tree, Cells cells,
                                          const Eigen::Isometry3d& T_M_G) {
  visualization_msgs::MarkerArray array;
  for (unsigned depth = 0; depth <= tree.getTreeDepth(); ++depth) {
    array.markers.push_back(emptyCubes(header, depth, tree.getNodeSize(depth)));
  }
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (tree.isNodeOccupied(*leaf) != (cells == Cells::Occupied)) continue;
    array.markers[leaf.getDepth()].points.push_back(tf2::toMsg(centreOf(leaf)));
  }
  for (Marker& marker : array.markers) {
    marker.action = marker.points.empty() ? Marker::DELETE : Marker::ADD;
    marker.color = cells == Cells::Occupied ? heightColour(0.0) : freeColour();
  }
  if (cells == Cells::Occupied) colourByHeight(array, T_M_G);
  return array;
}

sensor_msgs::PointCloud2 toCellCentres(const std_msgs::Header& header, const octomap::OcTree& tree) {
  pcl::PointCloud<pcl::PointXYZ> centres;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (!tree.isNodeOccupied(*leaf)) continue;
    const Eigen::Vector3f centre = centreOf(leaf).cast<float>();
    centres.push_back({centre.x(), centre.y(), centre.z()});
  }
  sensor_msgs::PointCloud2 message;
  pcl::toROSMsg(centres, message);
  message.header = header;
  return message;
}

nav_msgs::OccupancyGrid toProjectedMap(const std_msgs::Header& header, const octomap::OcTree& tree) {
  nav_msgs::OccupancyGrid grid;
  grid.header = header;
  grid.info.map_load_time = header.stamp;
  grid.info.resolution = static_cast<float>(tree.getResolution());
  Eigen::AlignedBox2d area;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) area.extend(footprint(leaf));
  if (area.isEmpty()) return grid;

  const Eigen::Array2d cells = (area.sizes() / tree.getResolution()).array().round();
  grid.info.width = static_cast<std::uint32_t>(cells.x());
  grid.info.height = static_cast<std::uint32_t>(cells.y());
  grid.info.origin.position.x = area.min().x();
  grid.info.origin.position.y = area.min().y();
  grid.info.origin.orientation.w = 1.0;
  grid.data.assign(static_cast<std::size_t>(grid.info.width) * grid.info.height, kGridUnknown);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const Eigen::AlignedBox2d square = footprint(leaf);
    const Eigen::Array2d first = ((square.min() - area.min()) / tree.getResolution()).array().round();
    const int count = static_cast<int>(std::lround(leaf.getSize() / tree.getResolution()));
    fill(grid, first.cast<int>().matrix(), count, tree.isNodeOccupied(*leaf) ? kGridOccupied : kGridFree);
  }
  return grid;
}

}  // namespace flight_corridor_ros
