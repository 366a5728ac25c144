#pragma once

#include <opencv2/calib3d.hpp>
#include <opencv2/ximgproc/disparity_filter.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Settings of OpenCV's semi-global matching and weighted least squares filter.
struct OpencvConfig {
  std::string mode = "3way";        ///< sgbm, hh, 3way or hh4 (cv::StereoSGBM modes).
  int block_size_px = 3;            ///< Edge of the matched block, odd.
  int smoothness_small = 4;         ///< P1 per pixel of the block: penalty of a disparity step of one.
  int smoothness_large = 12;        ///< P2 per pixel of the block: penalty of a larger step.
  int uniqueness_percent = 10;      ///< By how much the best match must beat the second.
  int left_right_max_px = 1;        ///< Largest left-right inconsistency; -1: not checked.
  double wls_lambda = 8000.0;       ///< Weight of smoothness in the WLS filter.
  double wls_sigma = 1.5;           ///< Sensitivity to image edges in the WLS filter.
  double wls_min_confidence = 0.5;  ///< Below, a WLS value is invented, not measured.
};
Violations check(const OpencvConfig& config);

/// The paper's matcher: cv::StereoSGBM and the WLS filter. It keeps one disparity a pixel and no doubt: its sets
/// are empty. Slow; for comparison. One object, one thread.
class OpencvMatcher {
 public:
  /// @throws std::invalid_argument with every broken rule.
  OpencvMatcher(const OpencvConfig& config, const StereoGeometry& geometry, int num_disparities);

  /// @param frame both images CV_8UC1 of geometry.size().  @param out refilled.
  void match(const StereoFrame& frame, DisparityEvidence& out);

 private:
  void pad(const cv::Mat& image, cv::Mat& padded) const;
  void write(DisparityEvidence& out) const;

  OpencvConfig config_;
  StereoGeometry geometry_;
  int min_disparity_px_;
  int pad_left_px_,
      pad_right_px_;     // SGBM skips columns that cannot see its whole search range: padding brings them back
  cv::Rect image_area_;  // of the padded images
  cv::Ptr<cv::StereoSGBM> matcher_, wls_left_matcher_;
  cv::Ptr<cv::StereoMatcher> wls_right_matcher_;
  cv::Ptr<cv::ximgproc::DisparityWLSFilter> wls_;
  cv::Mat balanced_right_, left_padded_, right_padded_, matched_, left_fixed_, right_fixed_, filtered_, confidence_;
};

}  // namespace flight_corridor
