#include "ros/clouds.hpp"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl_conversions/pcl_conversions.h>

#include <algorithm>
#include <cmath>

namespace flight_corridor_ros {

namespace {

using Points = pcl::PointCloud<pcl::PointXYZ>;

constexpr int kTile_px = 8;  // at 4 m and f = 350 px, 0.09 m: a cell of a costmap

void add(Points& points, const Eigen::Vector3f& p) { points.push_back({p.x(), p.y(), p.z()}); }

template <class Point>
sensor_msgs::PointCloud2 toMessage(const std_msgs::Header& header, const pcl::PointCloud<Point>& points) {
  sensor_msgs::PointCloud2 message;
  pcl::toROSMsg(points, message);
  message.header = header;
  return message;
}

/// Of a tile; NaN where too few of its pixels have a depth.
float nearestDepth(const cv::Mat& tile_m, double min_ray_fraction) {
  float nearest_m = INFINITY;
  int rays = 0;
  for (int v = 0; v < tile_m.rows; ++v) {
    for (int u = 0; u < tile_m.cols; ++u) {
      const float depth_m = tile_m.at<float>(v, u);
      if (!(depth_m > 0.0f)) continue;
      nearest_m = std::min(nearest_m, depth_m);
      ++rays;
    }
  }
  return rays >= std::max(1.0, min_ray_fraction * static_cast<double>(tile_m.total())) ? nearest_m : NAN;
}

}  // namespace

sensor_msgs::PointCloud2 toPointCloud(const std_msgs::Header& header, const flight_corridor::Cloud& cloud) {
  return toMessage(header, cloud);
}

sensor_msgs::PointCloud2 toObstacles(const std_msgs::Header& header, const octomap::OcTree& tree,
                                     const Eigen::Isometry3d& T_M_C, double max_range_m) {
  const Eigen::Isometry3d T_C_M = T_M_C.inverse();
  const double edge_m = tree.getResolution();
  Points points;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (!tree.isNodeOccupied(*leaf)) continue;
    const int count = static_cast<int>(std::lround(leaf.getSize() / edge_m));
    const Eigen::Vector3d first_M =
        Eigen::Vector3d(leaf.getX(), leaf.getY(), leaf.getZ()).array() - 0.5 * (leaf.getSize() - edge_m);
    for (int cell = 0; cell < count * count * count; ++cell) {
      const Eigen::Vector3d steps(cell % count, cell / count % count, cell / count / count);
      const Eigen::Vector3d p_C = T_C_M * (first_M + edge_m * steps);
      if (p_C.norm() <= max_range_m) add(points, p_C.cast<float>());
    }
  }
  return toMessage(header, points);
}

sensor_msgs::PointCloud2 toClearing(const std_msgs::Header& header, const cv::Mat& depth_m,
                                    const flight_corridor::StereoGeometry& geometry,
                                    const flight_corridor::MapConfig& config) {
  const cv::Rect image({}, depth_m.size());
  Points points;
  for (int v = 0; v < depth_m.rows; v += kTile_px) {
    for (int u = 0; u < depth_m.cols; u += kTile_px) {
      const cv::Rect tile = cv::Rect(u, v, kTile_px, kTile_px) & image;
      const float nearest_m = nearestDepth(depth_m(tile), config.min_ray_fraction);
      if (std::isnan(nearest_m)) continue;
      const double free_m = std::min<double>(geometry.shiftedDepth(nearest_m, config.free_band_px), config.max_range_m);
      const Eigen::Vector3d end_C = geometry.point(u + 0.5 * (tile.width - 1), v + 0.5 * (tile.height - 1), free_m);
      add(points, end_C.cast<float>());
    }
  }
  return toMessage(header, points);
}

}  // namespace flight_corridor_ros
