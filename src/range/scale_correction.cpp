#include "flight_corridor/range/scale_correction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kNotSignificant = 1.0, kSignificant = 2.0;  // sigmas: the correction is applied not at all, in full
constexpr double kMatchBias = 0.5;  // sigmas of a match, of all of one surface: more do not make it smaller

}  // namespace

ScaleCorrection::ScaleCorrection(const ScaleConfig& config) : config_(config) {
  throwIfBroken(check(config));
  least_ = 1.0 / (1.0 + config.max_correction);
  most_ = 1.0 / (1.0 - config.max_correction);
  covariance_ =
      Eigen::Vector2d(std::pow(config.prior_sigma, 2), std::pow(config.offset_prior_sigma_px, 2)).asDiagonal();
}

/// Measurement h = [d, 1], innovation y = d_expected - (a d + b), Kalman update. d in h is
/// the likeliest true disparity given both readings: with the measured one its noise would, at one range, pull
/// a towards 0 without end (errors in variables; Fuller 1987, ch. 1).
bool ScaleCorrection::update(double stamp_s, double measured_px, double expected_px, double measured_sigma_px,
                             double expected_sigma_px) {
  const double sigma_px = std::hypot(measured_sigma_px, expected_sigma_px);
  const bool usable = config_.enabled && measured_px > 0.0 && expected_px > 0.0 && sigma_px > 0.0 &&
                      std::isfinite(measured_px + expected_px + sigma_px);
  if (!usable) return false;
  // More is learnt than is ever applied, since far away an offset is a larger share of the disparity.
  const double applied_px = config_.max_correction * measured_px;
  const double offset_px = std::min(config_.offset_prior_sigma_px, applied_px), error_px = expected_px - measured_px;
  const double largest_px = applied_px + (error_px > 0.0 ? 1.0 : 0.5) * offset_px;  // outwards is the dangerous side
  if (!(std::abs(error_px) <= largest_px)) return false;
  forgetUntil(stamp_s);
  const double share = std::pow(expected_sigma_px / sigma_px, 2);
  const Eigen::Vector2d h(share * measured_px + (1.0 - share) * (expected_px - mean_[1]) / mean_[0], 1.0);
  const double innovation = expected_px - (mean_[0] * measured_px + mean_[1]);
  const double variance = h.dot(covariance_ * h) + sigma_px * sigma_px;
  if (!(innovation * innovation <= config_.gate_sigma * config_.gate_sigma * variance)) return false;

  const Eigen::Vector2d gain = covariance_ * h / variance;
  mean_ += gain * innovation;
  covariance_ -= gain * (h.transpose() * covariance_).eval();
  covariance_ = 0.5 * (covariance_ + covariance_.transpose().eval());
  applied_ = significant();
  return true;
}

/// A random walk of both, in proportion to their priors.
void ScaleCorrection::forgetUntil(double stamp_s) {
  const double since_s = stamp_s - stamp_s_;
  const Eigen::Vector2d prior(config_.prior_sigma, config_.offset_prior_sigma_px);
  if (since_s > 0.0) {
    const Eigen::Vector2d walk = config_.drift_sigma_per_sqrt_s / config_.prior_sigma * prior;
    covariance_.diagonal() += since_s * walk.cwiseAbs2();
  }
  const Eigen::Vector2d share = prior.cwiseQuotient(covariance_.diagonal().cwiseSqrt()).cwiseMin(1.0);
  covariance_ = (share.asDiagonal() * covariance_ * share.asDiagonal()).eval();
  if (!(stamp_s <= stamp_s_)) stamp_s_ = stamp_s;
}

/// The model, as far as it differs from a faultless rig by more than chance and the matches' bias explain: faultless
/// below kNotSignificant, itself from kSignificant on (Mahalanobis distance), between the two in proportion.
Eigen::Vector2d ScaleCorrection::significant() const {
  const Eigen::Vector2d faultless(1.0, 0.0), error = mean_ - faultless;
  Eigen::Matrix2d chance = covariance_;
  chance(1, 1) += std::pow(kMatchBias * config_.disparity_sigma_px, 2);
  const double sigmas = std::sqrt(error.dot(chance.ldlt().solve(error)));
  const double share = std::clamp((sigmas - kNotSignificant) / (kSignificant - kNotSignificant), 0.0, 1.0);
  return faultless + share * error;
}

/// First order: s = d / (a d + b), so sigma_s = s^2 sigma(a d + b) / d.
double ScaleCorrection::sigma(double disparity_px) const {
  return std::pow(scale(disparity_px), 2) * disparitySigma(disparity_px) / disparity_px;
}

double ScaleCorrection::disparitySigma(double disparity_px) const {
  const Eigen::Vector2d h(disparity_px, 1.0);
  return std::sqrt(h.dot(covariance_ * h));
}

double ScaleCorrection::largestError(double disparity_px) const {
  return std::max(config_.max_correction * disparity_px, config_.offset_prior_sigma_px);
}

void correctedDepth(const cv::Mat& disparity_px, const ScaleCorrection& correction, const StereoGeometry& geometry,
                    cv::Mat& depth_m) {
  depth_m.create(disparity_px.size(), CV_32FC1);
  for (int v = 0; v < depth_m.rows; ++v) {
    const auto* from = disparity_px.ptr<float>(v);
    auto* to = depth_m.ptr<float>(v);
    for (int u = 0; u < depth_m.cols; ++u) to[u] = static_cast<float>(geometry.depth(correction.correct(from[u])));
  }
}

}  // namespace flight_corridor
