#include "flight_corridor/view/cloud.hpp"

#include <pcl/filters/voxel_grid.h>

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

/// Noise is alone: enough of a pixel's neighbours must lie within 3 sigma_Z, which grows with the square of depth.
bool isSupported(const cv::Mat& depth_m, int u, int v, const StereoGeometry& geometry, const CloudConfig& config) {
  const float depth = depth_m.at<float>(v, u);
  const double reach_m = 3.0 * geometry.depthSigma(depth, config.disparity_sigma_px);
  int neighbours = -1;  // the pixel itself
  for (int y = std::max(0, v - 1); y <= std::min(depth_m.rows - 1, v + 1); ++y) {
    for (int x = std::max(0, u - 1); x <= std::min(depth_m.cols - 1, u + 1); ++x) {
      neighbours += std::abs(depth_m.at<float>(y, x) - depth) <= reach_m;
    }
  }
  return neighbours >= config.min_neighbours;
}

}  // namespace

Cloud toCloud(const cv::Mat& depth_m, const cv::Mat& left, const StereoGeometry& geometry, const CloudConfig& config,
              double voxel_m) {
  const auto dense = pcl::make_shared<Cloud>();
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const float depth = depth_m.at<float>(v, u);
      if (!(depth <= config.max_range_m) || !isSupported(depth_m, u, v, geometry, config)) continue;
      pcl::PointXYZI point;
      point.getVector3fMap() = geometry.point(u, v, depth).cast<float>();
      point.intensity = left.at<std::uint8_t>(v, u);
      dense->push_back(point);
    }
  }
  pcl::VoxelGrid<pcl::PointXYZI> grid;
  const float edge_m = static_cast<float>(voxel_m);
  grid.setLeafSize(edge_m, edge_m, edge_m);
  grid.setInputCloud(dense);
  Cloud cloud;
  grid.filter(cloud);
  return cloud;
}

Cloud toCloud(const Pipeline& pipeline) {
  const Config& config = pipeline.config();
  return toCloud(pipeline.depth(), pipeline.left(), pipeline.geometry(), config.cloud, config.map.resolution_m);
}

}  // namespace flight_corridor
