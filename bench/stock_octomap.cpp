#include "stock_octomap.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor::bench {

void toPixels(const cv::Mat& fixed, const StereoGeometry& geometry, cv::Mat& disparity_px) {
  fixed.convertTo(disparity_px, CV_32F, 1.0 / cv::StereoMatcher::DISP_SCALE, -geometry.principalPointDifference());
}

void StockOctomap::insert(const cv::Mat& left, const cv::Mat& right) {
  matcher_->compute(left, right, fixed_);
  toPixels(fixed_, geometry_, disparity_px_);
  makeCloud();
  tree_.clear();
  tree_.insertPointCloud(cloud_, {0, 0, 0}, kMaxRange_m);
}

void StockOctomap::makeCloud() {
  cloud_.clear();
  for (int v = 0; v < disparity_px_.rows; ++v) {
    for (int u = 0; u < disparity_px_.cols; ++u) {
      const double depth_m = geometry_.depth(disparity_px_.at<float>(v, u));  // NaN where nothing matched
      if (std::isnan(depth_m)) continue;
      const Eigen::Vector3f point = geometry_.point(u, v, depth_m).cast<float>();
      cloud_.push_back(point.x(), point.y(), point.z());
    }
  }
}

double StockOctomap::clearDistance(const Box& box_C, int enough) const {
  std::unordered_map<octomap::OcTreeKey, int, octomap::OcTreeKey::KeyHash> counts;
  for (const octomap::point3d& point : cloud_) ++counts[tree_.coordToKey(point)];
  double nearest_m = kInfinity;
  for (const auto& [key, count] : counts) {
    if (count < enough) continue;
    const octomap::point3d centre = tree_.keyToCoord(key);
    const octomap::OcTreeNode* leaf = tree_.search(key);
    if (!leaf || !tree_.isNodeOccupied(leaf)) continue;
    if (!intersects(box_C, {centre.x(), centre.y(), centre.z()}, kResolution_m)) continue;
    nearest_m = std::min(nearest_m, std::max(0.0, centre.z() - kResolution_m / 2));
  }
  return nearest_m;
}

}  // namespace flight_corridor::bench
