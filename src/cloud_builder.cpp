#include "flight_corridor/cloud_builder.hpp"

#include <pcl/filters/voxel_grid.h>

#include <algorithm>
#include <cmath>

namespace flight_corridor {

Violations check(const CloudConfig& config) {
  Rules rules("cloud");
  rules.require(config.max_range_m > 0.0, "max_range_m", "positive", config.max_range_m);
  rules.require(0 <= config.min_neighbours && config.min_neighbours <= 8, "min_neighbours", "0 to 8",
                config.min_neighbours);
  rules.require(config.disparity_sigma_px > 0.0, "disparity_sigma_px", "positive", config.disparity_sigma_px);
  return rules.broken();
}

CloudBuilder::CloudBuilder(const CloudConfig& config, const StereoGeometry& geometry)
    : config_(config), geometry_(geometry) {
  throwIfBroken(check(config));
}

void CloudBuilder::depth(const cv::Mat& disparity_px, const ScaleCorrection& correction, cv::Mat& depth_m) const {
  depth_m.create(disparity_px.size(), CV_32FC1);
  for (int v = 0; v < depth_m.rows; ++v) {
    const auto* from = disparity_px.ptr<float>(v);
    auto* to = depth_m.ptr<float>(v);
    for (int u = 0; u < depth_m.cols; ++u) to[u] = static_cast<float>(geometry_.depth(correction.correct(from[u])));
  }
}

void CloudBuilder::cloud(const cv::Mat& depth_m, const cv::Mat& left, double voxel_m, Cloud& out) {
  dense_->clear();
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const float depth = depth_m.at<float>(v, u);
      if (!(depth <= config_.max_range_m) || !isSupported(depth_m, u, v)) continue;
      pcl::PointXYZI point;
      point.getVector3fMap() = geometry_.point(u, v, depth).cast<float>();
      point.intensity = left.at<std::uint8_t>(v, u);
      dense_->push_back(point);
    }
  }
  pcl::VoxelGrid<pcl::PointXYZI> grid;
  const float edge_m = static_cast<float>(voxel_m);
  grid.setLeafSize(edge_m, edge_m, edge_m);
  grid.setInputCloud(dense_);
  grid.filter(out);
}

/// Noise is alone: enough of a pixel's neighbours must lie within 3 sigma_Z, which grows with the square of depth.
bool CloudBuilder::isSupported(const cv::Mat& depth_m, int u, int v) const {
  const float depth = depth_m.at<float>(v, u);
  const double reach_m = 3.0 * geometry_.depthSigma(depth, config_.disparity_sigma_px);
  int neighbours = -1;  // the pixel itself
  for (int y = std::max(0, v - 1); y <= std::min(depth_m.rows - 1, v + 1); ++y) {
    for (int x = std::max(0, u - 1); x <= std::min(depth_m.cols - 1, u + 1); ++x) {
      neighbours += std::abs(depth_m.at<float>(y, x) - depth) <= reach_m;
    }
  }
  return neighbours >= config_.min_neighbours;
}

}  // namespace flight_corridor
