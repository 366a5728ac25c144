#pragma once

#include <opencv2/calib3d.hpp>
#include <opencv2/ximgproc/disparity_filter.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/range_fusion.hpp"
#include "stock_octomap.hpp"

namespace flight_corridor::bench {

/// The paper's matcher: StereoSGBM and the WLS filter, with the settings of OpenCV's sample disparity_filtering.cpp.
/// The filter leaves no pixel out.
class FilledDisparity {
 public:
  explicit FilledDisparity(int disparities_px = kDisparities_px);

  /// @param left, right CV_8UC1.  @param disparity_px refilled: CV_32FC1, principal-point difference removed.
  void compute(const cv::Mat& left, const cv::Mat& right, const StereoGeometry& geometry, cv::Mat& disparity_px);

 private:
  cv::Ptr<cv::StereoSGBM> matcher_;
  cv::Ptr<cv::StereoMatcher> right_matcher_;
  cv::Ptr<cv::ximgproc::DisparityWLSFilter> filter_;
  cv::Mat left_fixed_, right_fixed_, filled_fixed_;
};

/// The paper's Kalman filter: its measurement variances, no gate, and the process noise that it lacks.
FusionConfig paperFusion();

}  // namespace flight_corridor::bench
