#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `scale/` of doc/parameters.md: the rig's possible error, and how it is learnt.
struct ScaleConfig {
  bool enabled = true;
  double max_correction = 0.15;
  double prior_sigma = 0.07;
  double offset_prior_sigma_px = 0.7;
  double disparity_sigma_px = 0.1;
  double drift_sigma_per_sqrt_s = 0.001;
  double gate_sigma = 3.0;
};
Violations check(const ScaleConfig& config);

/// Learns how the rig's disparity must be corrected so that stereo's depth equals the fused range's: d_true = a*d + b,
/// a Bayesian linear regression in disparity. At a single range the prior splits the error between a (baseline, focal
/// length) and b (relative yaw); a varying range separates them. Both are forgotten slowly: heat and knocks change a
/// rig. The correction is applied once it is significant: a faultless rig stays unchanged.
class ScaleCorrection {
 public:
  /// @throws std::invalid_argument with every broken rule.
  explicit ScaleCorrection(const ScaleConfig& config);

  /// One pair of measured and expected disparity [px], each with the sigma of its error.
  /// @return whether the pair passed the gate.
  bool update(double stamp_s, double measured_px, double expected_px, double measured_sigma_px,
              double expected_sigma_px);

  /// The estimate becomes less certain until a stamp, at most as uncertain as the prior.
  void forgetUntil(double stamp_s);

  /// Corrected disparity [px]; NaN stays NaN. Bounded: f*B/result within 1 +- max_correction of f*B/disparity.
  double correct(double disparity_px) const {
    if (!(disparity_px > 0.0)) return kNaN;
    return std::clamp(applied_[0] * disparity_px + applied_[1], least_ * disparity_px, most_ * disparity_px);
  }

  /// Depth after / depth before correction at a disparity [-].
  double scale(double disparity_px) const { return disparity_px / correct(disparity_px); }
  /// One sigma of scale() [-].
  double sigma(double disparity_px) const;
  /// One sigma of a corrected disparity, from the rig's uncertainty alone [px].
  double disparitySigma(double disparity_px) const;
  /// Largest error of a correctable rig [px]: the largest correction, or one sigma of the offset, which is more far
  /// away.
  double largestError(double disparity_px) const;

 private:
  Eigen::Vector2d significant() const;

  ScaleConfig config_;
  double least_, most_;  // corrected disparity over disparity
  double stamp_s_ = kNaN;
  Eigen::Vector2d mean_{1.0, 0.0};  // a [-], b [px]
  Eigen::Matrix2d covariance_;
  Eigen::Vector2d applied_{1.0, 0.0};  // as mean_, if significant
};

/// Depth along z of C of corrected disparities.
/// @param disparity_px CV_32FC1, NaN = nothing.  @param depth_m refilled: CV_32FC1 [m] of the same size.
void correctedDepth(const cv::Mat& disparity_px, const ScaleCorrection& correction, const StereoGeometry& geometry,
                    cv::Mat& depth_m);

}  // namespace flight_corridor
