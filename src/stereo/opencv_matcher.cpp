#include "flight_corridor/stereo/opencv_matcher.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "flight_corridor/stereo/exposure.hpp"
#include "flight_corridor/stereo/search_range.hpp"

namespace flight_corridor {

namespace {

constexpr int kFixedPoint = cv::StereoMatcher::DISP_SCALE;

std::optional<int> matcherMode(const std::string& name) {
  if (name == "sgbm") return cv::StereoSGBM::MODE_SGBM;
  if (name == "hh") return cv::StereoSGBM::MODE_HH;
  if (name == "3way") return cv::StereoSGBM::MODE_SGBM_3WAY;
  if (name == "hh4") return cv::StereoSGBM::MODE_HH4;
  return std::nullopt;
}

cv::Ptr<cv::StereoSGBM> makeMatcher(const OpencvConfig& config, int min_disparity_px, int num_disparities) {
  const int area = config.block_size_px * config.block_size_px;
  auto matcher = cv::StereoSGBM::create(min_disparity_px, num_disparities, config.block_size_px,
                                        config.smoothness_small * area, config.smoothness_large * area);
  matcher->setMode(*matcherMode(config.mode));
  return matcher;
}

}  // namespace

Violations check(const OpencvConfig& config) {
  Rules rules("stereo");
  rules.require(matcherMode(config.mode).has_value(), "mode", "sgbm, hh, 3way or hh4", config.mode);
  rules.require(1 <= config.block_size_px && config.block_size_px <= 21 && config.block_size_px % 2 == 1,
                "block_size_px", "odd, 1 to 21", config.block_size_px);
  rules.require(config.smoothness_small > 0, "smoothness_small", "positive", config.smoothness_small);
  rules.require(config.smoothness_large > config.smoothness_small, "smoothness_large", "above smoothness_small",
                config.smoothness_large);
  rules.require(0 <= config.uniqueness_percent && config.uniqueness_percent < 100, "uniqueness_percent", "0 to 99",
                config.uniqueness_percent);
  rules.require(config.left_right_max_px >= -1, "left_right_max_px", "-1 (off) or more", config.left_right_max_px);
  rules.require(config.wls_lambda > 0.0, "wls_lambda", "positive", config.wls_lambda);
  rules.require(config.wls_sigma > 0.0, "wls_sigma", "positive", config.wls_sigma);
  rules.require(0.0 < config.wls_min_confidence && config.wls_min_confidence <= 1.0, "wls_min_confidence",
                "above 0, up to 1", config.wls_min_confidence);
  return rules.broken();
}

OpencvMatcher::OpencvMatcher(const OpencvConfig& config, const StereoGeometry& geometry, int num_disparities)
    : config_(config),
      geometry_(geometry),
      min_disparity_px_(smallestDisparity(geometry)),
      pad_left_px_(std::max(0, min_disparity_px_ + num_disparities)),
      pad_right_px_(std::max(0, -min_disparity_px_)),
      image_area_({pad_left_px_, 0}, geometry.size()) {
  throwIfBroken(check(config));
  matcher_ = makeMatcher(config, min_disparity_px_, num_disparities);
  matcher_->setUniquenessRatio(config.uniqueness_percent);
  matcher_->setDisp12MaxDiff(config.left_right_max_px);
  wls_left_matcher_ = makeMatcher(config, min_disparity_px_, num_disparities);  // the factory rewrites its settings
  wls_ = cv::ximgproc::createDisparityWLSFilter(wls_left_matcher_);
  wls_right_matcher_ = cv::ximgproc::createRightMatcher(wls_left_matcher_);
  wls_->setLambda(config.wls_lambda);
  wls_->setSigmaColor(config.wls_sigma);
}

void OpencvMatcher::pad(const cv::Mat& image, cv::Mat& padded) const {
  cv::copyMakeBorder(image, padded, 0, 0, pad_left_px_, pad_right_px_, cv::BORDER_REPLICATE);
}

void OpencvMatcher::match(const StereoFrame& frame, DisparityEvidence& out) {
  balanceExposure(frame.left, frame.right, balanced_right_);
  pad(frame.left, left_padded_);
  pad(balanced_right_, right_padded_);
  matcher_->compute(left_padded_, right_padded_, matched_);
  wls_left_matcher_->compute(left_padded_, right_padded_, left_fixed_);
  wls_right_matcher_->compute(right_padded_, left_padded_, right_fixed_);
  wls_->filter(left_fixed_, left_padded_, filtered_, right_fixed_);
  wls_->getConfidenceMap().convertTo(confidence_, CV_32F, 1.0 / 255.0);
  write(out);
}

/// The match, where there is one, else the filter's value if it is confident.
void OpencvMatcher::write(DisparityEvidence& out) const {
  const cv::Mat matched = matched_(image_area_), filtered = filtered_(image_area_);
  const cv::Mat confidence = confidence_(image_area_);
  const int smallest = min_disparity_px_ * kFixedPoint;  // the matcher marks with one below
  const auto difference_px = static_cast<float>(geometry_.principalPointDifference());
  out.best_px.create(geometry_.size(), CV_32FC1);
  for (int v = 0; v < out.best_px.rows; ++v) {
    for (int u = 0; u < out.best_px.cols; ++u) {
      std::int16_t fixed = matched.at<std::int16_t>(v, u);
      const bool is_filled = confidence.at<float>(v, u) >= config_.wls_min_confidence;
      if (fixed < smallest && is_filled) fixed = filtered.at<std::int16_t>(v, u);
      const int farthest = std::max(smallest, (u - (out.best_px.cols - 1)) * kFixedPoint);  // on the right image
      const bool is_valid = farthest <= fixed && fixed <= u * kFixedPoint;
      const float none = std::numeric_limits<float>::quiet_NaN();
      out.best_px.at<float>(v, u) =
          is_valid ? plausible(static_cast<float>(fixed) / kFixedPoint - difference_px) : none;
    }
  }
  out.best_px.copyTo(out.farthest_px);
  out.best_px.copyTo(out.nearest_px);
  for (cv::Mat* unknown : {&out.repeated_px, &out.competitor_farthest_px, &out.competitor_nearest_px}) {
    unknown->create(geometry_.size(), CV_32FC1);
    unknown->setTo(std::numeric_limits<float>::quiet_NaN());
  }
  out.flags = cv::Mat::zeros(geometry_.size(), CV_8UC1);
  out.set = cv::Mat::zeros(geometry_.size(), CV_8UC(8));
}

}  // namespace flight_corridor
