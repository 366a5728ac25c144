#include "filled_disparity.hpp"

namespace flight_corridor::bench {

FilledDisparity::FilledDisparity(int disparities_px) : matcher_(cv::StereoSGBM::create(0, disparities_px, 3)) {
  matcher_->setP1(24 * 3 * 3);
  matcher_->setP2(96 * 3 * 3);
  matcher_->setPreFilterCap(63);
  matcher_->setMode(cv::StereoSGBM::MODE_SGBM_3WAY);
  filter_ = cv::ximgproc::createDisparityWLSFilter(matcher_);
  filter_->setLambda(8000.0);
  filter_->setSigmaColor(1.5);
  right_matcher_ = cv::ximgproc::createRightMatcher(matcher_);
}

void FilledDisparity::compute(const cv::Mat& left, const cv::Mat& right, const StereoGeometry& geometry,
                              cv::Mat& disparity_px) {
  matcher_->compute(left, right, left_fixed_);
  right_matcher_->compute(right, left, right_fixed_);
  filter_->filter(left_fixed_, left, filled_fixed_, right_fixed_);
  toPixels(filled_fixed_, geometry, disparity_px);
}

FusionConfig paperFusion() {
  FusionConfig config;
  config.stereo_variance_m2 = 0.0254800198;
  config.lidar_variance_m2 = 0.0005798584;
  config.gate_sigma = kInfinity;
  return config;
}

}  // namespace flight_corridor::bench
