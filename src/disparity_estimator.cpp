#include "flight_corridor/disparity_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

#include "flight_corridor/exposure.hpp"

namespace flight_corridor {

namespace {

constexpr int kFixedPoint = cv::StereoMatcher::DISP_SCALE;
constexpr int kBelowZero_px = 2;           // disparities searched below zero: far surfaces of a rig with offset
constexpr double kLargestOffset_px = 1.5;  // of such a rig
constexpr double kBrightGrey = 100.0;      // mean grey of an image in good light
constexpr double kDimNoise = 2.0 / 3.0;    // what remains of a bright image's noise in the dark, by the electronics
constexpr double kRightTexture = 0.5;      // of what the left image must have: the right one sees edges elsewhere
constexpr int kSupport_px = 31;            // matches so far around support a fill
constexpr double kSupportSlack_px = 1.0;   // rounding of disparity at half size
constexpr double kLeastWeight = 1e-3;      // about one match around
constexpr float kSmallestDisparity_px = 1.0f / kFixedPoint;  // "as far as can be told"

std::optional<int> matcherMode(const std::string& name) {
  if (name == "sgbm") return cv::StereoSGBM::MODE_SGBM;
  if (name == "hh") return cv::StereoSGBM::MODE_HH;
  if (name == "3way") return cv::StereoSGBM::MODE_SGBM_3WAY;
  if (name == "hh4") return cv::StereoSGBM::MODE_HH4;
  return std::nullopt;
}

/// Even, so that images at half size keep their columns together.
int evenAbove(int padding_px) { return std::max(0, padding_px + padding_px % 2); }

cv::Ptr<cv::StereoSGBM> makeMatcher(const StereoConfig& config, int min_disparity_px, int num_disparities_px) {
  const int area = config.block_size_px * config.block_size_px;
  auto matcher = cv::StereoSGBM::create(min_disparity_px, num_disparities_px, config.block_size_px,
                                        config.smoothness_small * area, config.smoothness_large * area);
  matcher->setMode(*matcherMode(config.mode));
  return matcher;
}

}  // namespace

Violations check(const StereoConfig& config) {
  Rules rules("stereo");
  rules.require(matcherMode(config.mode).has_value(), "mode", "sgbm, hh, 3way or hh4", config.mode);
  rules.require(
      config.num_disparities_px > 0 && config.num_disparities_px <= 1024 && config.num_disparities_px % 32 == 0,
      "num_disparities_px", "a multiple of 32, up to 1024", config.num_disparities_px);
  rules.require(1 <= config.block_size_px && config.block_size_px <= 21 && config.block_size_px % 2 == 1,
                "block_size_px", "odd, 1 to 21", config.block_size_px);
  rules.require(config.smoothness_small > 0, "smoothness_small", "positive", config.smoothness_small);
  rules.require(config.smoothness_large > config.smoothness_small, "smoothness_large", "above smoothness_small",
                config.smoothness_large);
  rules.require(0 <= config.uniqueness_percent && config.uniqueness_percent < 100, "uniqueness_percent", "0 to 99",
                config.uniqueness_percent);
  rules.require(config.left_right_max_px >= -1, "left_right_max_px", "-1 (off) or more", config.left_right_max_px);
  rules.require(config.speckle_window_px >= 0, "speckle_window_px", "not negative", config.speckle_window_px);
  rules.require(config.speckle_range_px >= 0, "speckle_range_px", "not negative", config.speckle_range_px);
  rules.require(config.texture_min >= 0.0, "texture_min", "not negative", config.texture_min);
  rules.require(config.wls_lambda > 0.0, "wls_lambda", "positive", config.wls_lambda);
  rules.require(config.wls_sigma > 0.0, "wls_sigma", "positive", config.wls_sigma);
  rules.require(0.0 < config.wls_min_confidence && config.wls_min_confidence <= 1.0, "wls_min_confidence",
                "above 0, up to 1", config.wls_min_confidence);
  rules.require(0.0 <= config.min_matched_fraction && config.min_matched_fraction <= 1.0, "min_matched_fraction",
                "0 to 1", config.min_matched_fraction);
  return rules.broken();
}

DisparityEstimator::DisparityEstimator(const StereoConfig& config, const StereoGeometry& geometry)
    : config_(config),
      geometry_(geometry),
      min_disparity_px_(static_cast<int>(std::floor(geometry.principalPointDifference())) - kBelowZero_px),
      pad_left_px_(evenAbove(min_disparity_px_ + config.num_disparities_px)),
      pad_right_px_(evenAbove(-min_disparity_px_)),
      image_area_({pad_left_px_, 0}, geometry.size()),
      island_filter_(config.speckle_window_px, config.speckle_range_px),
      level_matcher_(min_disparity_px_, config.num_disparities_px) {
  throwIfBroken(check(config));
  if (geometry.size().width <= config.num_disparities_px) {
    throw std::invalid_argument("stereo/num_disparities_px: below the image's width (" +
                                std::to_string(config.num_disparities_px) + ", " +
                                std::to_string(geometry.size().width) + ")");
  }
  if (geometry.size().height < 2) throw std::invalid_argument("images must be 2 or more pixels high");
  matcher_ = makeMatcher(config, min_disparity_px_, config.num_disparities_px);
  matcher_->setUniquenessRatio(config.uniqueness_percent);
  matcher_->setDisp12MaxDiff(config.left_right_max_px);

  // The filter's factory rewrites its matcher's settings, so it gets one of its own, at half size: it only fills.
  wls_left_matcher_ =
      makeMatcher(config, static_cast<int>(std::floor(min_disparity_px_ / 2.0)), config.num_disparities_px / 2);
  wls_ = cv::ximgproc::createDisparityWLSFilter(wls_left_matcher_);
  wls_right_matcher_ = cv::ximgproc::createRightMatcher(wls_left_matcher_);
  wls_->setLambda(config.wls_lambda);
  wls_->setSigmaColor(config.wls_sigma);
}

void DisparityEstimator::estimate(const StereoFrame& frame, Disparity& out) {
  balanceExposure(frame.left, frame.right, balanced_right_);
  pad(frame.left, left_padded_);
  pad(balanced_right_, right_padded_);
  match(frame.left, out);
  fill(out);
}

void DisparityEstimator::pad(const cv::Mat& image, cv::Mat& padded) const {
  cv::copyMakeBorder(image, padded, 0, 0, pad_left_px_, pad_right_px_, cv::BORDER_REPLICATE);
}

void DisparityEstimator::match(const cv::Mat& left, Disparity& out) {
  matcher_->compute(left_padded_, right_padded_, left_fixed_);
  left_fixed_(image_area_).copyTo(matched_fixed_);
  const auto unmatched = static_cast<std::int16_t>((min_disparity_px_ - 1) * kFixedPoint);
  island_filter_.filter(left, balanced_right_, matched_fixed_, unmatched, out.small);

  // Where nothing varies along the row, in one image or the other, every disparity matches.
  measureTexture(left, out.texture);
  out.least_texture = leastTexture(left);
  cv::compare(out.texture, out.least_texture, keep_, cv::CMP_GE);
  measureTexture(balanced_right_, right_texture_);
  rejectBare(kRightTexture * leastTexture(balanced_right_));
  toPixels(matched_fixed_, keep_, out.matched_px);
  level_matcher_.match(left, balanced_right_, out.matched_px, out.level);
  refiner_.refine(left, balanced_right_, out.matched_px, out.thin);
  removeDifference(out.matched_px);
  out.matched_fraction = cv::countNonZero(out.matched_px == out.matched_px) / static_cast<double>(left.total());
}

void DisparityEstimator::measureTexture(const cv::Mat& image, cv::Mat& texture) {
  cv::Sobel(image, gradient_, CV_16S, 1, 0, 1, 0.5);
  cv::convertScaleAbs(gradient_, gradient_);
  cv::boxFilter(gradient_, texture, CV_32F, {config_.block_size_px, config_.block_size_px});
}

/// Keeps no match that has less texture in the right image.
void DisparityEstimator::rejectBare(double least_texture) {
  for (int v = 0; v < keep_.rows; ++v) {
    const auto* fixed = matched_fixed_.ptr<std::int16_t>(v);
    const auto* texture = right_texture_.ptr<float>(v);
    auto* keep = keep_.ptr<std::uint8_t>(v);
    for (int u = 0; u < keep_.cols; ++u) {
      const int at = std::clamp(u - cvFloor(fixed[u] / static_cast<double>(kFixedPoint) + 0.5), 0, keep_.cols - 1);
      if (texture[at] < least_texture) keep[u] = 0;
    }
  }
}

/// Photon noise falls with the square root of light, and with it what can pass for texture.
double DisparityEstimator::leastTexture(const cv::Mat& image) const {
  const double noise = std::sqrt(cv::mean(image)[0] / kBrightGrey);  // beside that of a bright image
  return config_.texture_min * std::clamp(noise, kDimNoise, 1.0);
}

void DisparityEstimator::fill(Disparity& out) {
  cv::resize(left_padded_, left_half_, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::resize(right_padded_, right_half_, {}, 0.5, 0.5, cv::INTER_AREA);
  wls_left_matcher_->compute(left_half_, right_half_, left_fixed_);
  wls_right_matcher_->compute(right_half_, left_half_, right_fixed_);
  wls_->filter(left_fixed_, left_padded_, filtered_fixed_, right_fixed_);
  wls_->getConfidenceMap()(image_area_).convertTo(out.confidence, CV_32F, 1.0 / 255.0);
  cv::compare(out.confidence, config_.wls_min_confidence, keep_, cv::CMP_GE);
  toPixels(filtered_fixed_(image_area_), keep_, out.filtered_px);
  removeDifference(out.filtered_px);
  rejectInvented(out);
  alignFill(out);
}

/// A fill interpolates: what lies outside the matches around it, or has none around it, was invented, however
/// confident.
void DisparityEstimator::rejectInvented(Disparity& out) {
  static const cv::Mat kAround = cv::getStructuringElement(cv::MORPH_RECT, {kSupport_px, kSupport_px});
  const cv::Mat unmatched = ~(out.matched_px == out.matched_px);  // NaN != NaN is false in OpenCV's vector code
  out.matched_px.copyTo(support_);
  support_.setTo(-kInfinity, unmatched);
  cv::dilate(support_, highest_, kAround);
  support_.setTo(kInfinity, unmatched);
  cv::erode(support_, lowest_, kAround);
  cv::bitwise_or(out.filtered_px > highest_ + kSupportSlack_px, out.filtered_px < lowest_ - kSupportSlack_px, keep_);
  out.filtered_px.setTo(kNaN, keep_);
}

/// Half size draws a fill towards whole pixels, by up to half a pixel: it is moved by what the matches around, on the
/// same surface, differ from it in the mean.
void DisparityEstimator::alignFill(Disparity& out) {
  cv::subtract(out.matched_px, out.filtered_px, difference_);
  cv::compare(cv::abs(difference_), kSupportSlack_px, keep_, cv::CMP_LE);
  difference_.setTo(0.0, ~keep_);
  keep_.convertTo(weight_, CV_32F, 1.0 / 255.0);
  cv::boxFilter(difference_, difference_, CV_32F, {kSupport_px, kSupport_px});
  cv::boxFilter(weight_, weight_, CV_32F, {kSupport_px, kSupport_px});
  cv::divide(difference_, cv::max(weight_, kLeastWeight), difference_);
  out.filtered_px += difference_;
}

double DisparityEstimator::nearestDepth() const {
  return geometry_.depth(min_disparity_px_ + config_.num_disparities_px - 1 - geometry_.principalPointDifference());
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

/// Fixed point to pixels; what is not kept, not matched or not on the right image: NaN.
void DisparityEstimator::toPixels(const cv::Mat& fixed, const cv::Mat& keep, cv::Mat& disparity_px) const {
  disparity_px.create(fixed.size(), CV_32FC1);
  const int smallest = min_disparity_px_ * kFixedPoint;  // the matcher marks with one below
  for (int v = 0; v < fixed.rows; ++v) {
    const auto* in = fixed.ptr<std::int16_t>(v);
    const auto* kept = keep.ptr<std::uint8_t>(v);
    auto* out = disparity_px.ptr<float>(v);
    for (int u = 0; u < fixed.cols; ++u) {
      const bool valid = kept[u] && in[u] >= smallest && in[u] <= u * kFixedPoint;
      out[u] = valid ? static_cast<float>(in[u]) / kFixedPoint : std::numeric_limits<float>::quiet_NaN();
    }
  }
}

/// A match far below zero is a wrong one; a little below, of a rig with an offset.
void DisparityEstimator::removeDifference(cv::Mat& disparity_px) const {
  disparity_px -= geometry_.principalPointDifference();
  disparity_px.setTo(kNaN, disparity_px < -kLargestOffset_px);
  disparity_px.setTo(kSmallestDisparity_px, disparity_px < kSmallestDisparity_px);
}

}  // namespace flight_corridor
