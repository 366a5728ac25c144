#include "flight_corridor/stereo/disparity_estimator.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "flight_corridor/stereo/search_range.hpp"

namespace flight_corridor {

namespace {

constexpr int kMostByOpencv_px = 1024;

int threads() { return std::max(1, cv::getNumThreads()); }

}  // namespace

Violations check(const StereoConfig& config) {
  Rules rules("stereo");
  const bool is_own = config.engine == "semi_global";
  rules.require(is_own || config.engine == "opencv", "engine", "semi_global or opencv", config.engine);
  const int most_px = is_own ? kLargestDisparities : kMostByOpencv_px;
  rules.require(
      0 < config.num_disparities_px && config.num_disparities_px <= most_px && config.num_disparities_px % 32 == 0,
      "num_disparities_px", "a multiple of 32, up to " + std::to_string(most_px), config.num_disparities_px);
  rules.require(0.0 <= config.min_matched_fraction && config.min_matched_fraction <= 1.0, "min_matched_fraction",
                "0 to 1", config.min_matched_fraction);
  Violations broken = rules.broken();
  for (const std::string& rule : check(config.opencv)) broken.push_back(rule);
  return broken;
}

DisparityEstimator::DisparityEstimator(const StereoConfig& config, const StereoGeometry& geometry,
                                       double smallest_obstacle_m)
    : num_disparities_(config.num_disparities_px), geometry_(geometry), coherent_(geometry, smallest_obstacle_m, threads()) {
  throwIfBroken(check(config));
  if (geometry.size().width <= num_disparities_) {
    throw std::invalid_argument("stereo/num_disparities_px: below the image's width (" +
                                std::to_string(num_disparities_) + ", " + std::to_string(geometry.size().width) + ")");
  }
  if (geometry.size().height < 2) throw std::invalid_argument("images must be 2 or more pixels high");
  if (config.engine == "opencv") {
    opencv_ = std::make_unique<OpencvMatcher>(config.opencv, geometry, num_disparities_);
  } else {
    semi_global_ = std::make_unique<EvidenceMatcher>(geometry, num_disparities_, threads());
  }
}

void DisparityEstimator::estimate(const StereoFrame& frame, Disparity& out) {
  if (opencv_) {
    opencv_->match(frame, out);
  } else {
    semi_global_->match(frame, out);
  }
  out.matched_fraction = coherent_.keep(out.best_px, out.repeated_px) / static_cast<double>(out.best_px.total());
}

double DisparityEstimator::nearestDepth() const {
  return geometry_.depth(firstDisparity(geometry_) + num_disparities_ - 1);
}

/// 0 <= u = fx x/z + cx is fx x + cx z >= 0, and so on; in the right image x is less by the baseline.
ConvexRegion DisparityEstimator::observable() const {
  const StereoCalibration& rig = geometry_.calibration();
  const double last_u_px = rig.size_px.width - 1, last_v_px = rig.size_px.height - 1;
  ConvexRegion region_C(4, 5);
  region_C.col(0) << rig.fx_px, 0.0, rig.cx_px, 0.0;
  region_C.col(1) << -rig.fx_px, 0.0, last_u_px - rig.cx_px, 0.0;
  region_C.col(2) << 0.0, rig.fy_px, rig.cy_px, 0.0;
  region_C.col(3) << 0.0, -rig.fy_px, last_v_px - rig.cy_px, 0.0;
  region_C.col(4) << rig.fx_px, 0.0, rig.cx_right_px, -rig.fx_px * rig.baseline_m;
  for (int side = 0; side < 5; ++side) region_C.col(side) /= region_C.col(side).head<3>().norm();
  return region_C;
}

}  // namespace flight_corridor
