#include "flight_corridor/window_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

namespace {

constexpr int kWindow_px = 2 * WindowMatcher::kReach_px + 1;
constexpr int kWindowArea_px = kWindow_px * kWindow_px;
constexpr float kLeastContrast = 1.0f;  // [grey] of a window, to be divided by

}  // namespace

WindowMatcher::WindowMatcher(const cv::Mat& left, const cv::Mat& right, cv::Range rows)
    : first_row_(std::max(rows.start - kReach_px, 0)) {
  rows = {first_row_, std::min(rows.end + kReach_px, left.rows)};
  left_ = left.rowRange(rows);
  right.rowRange(rows).convertTo(right_, CV_32F);
  cv::Mat mean, mean_of_squares;
  cv::boxFilter(right_, mean, CV_32F, {kWindow_px, kWindow_px});
  cv::sqrBoxFilter(right_, mean_of_squares, CV_32F, {kWindow_px, kWindow_px});
  cv::sqrt(cv::max(mean_of_squares - mean.mul(mean), kLeastContrast * kLeastContrast), contrast_);
}

float WindowMatcher::correlation(int u, int v, int first_px, int last_px, std::vector<float>& scratch) const {
  v -= first_row_;
  if (v < kReach_px || v + kReach_px >= left_.rows || u < kReach_px || u + kReach_px >= left_.cols) return -1.0f;
  const int first = std::max(u - last_px, kReach_px), last = std::min(u - first_px, right_.cols - 1 - kReach_px);
  if (last < first) return -1.0f;
  float window[kWindowArea_px];
  const float contrast = centredWindow(u, v, window);
  scratch.assign(last - first + 1, 0.0f);  // covariances
  for (int i = 0; i < kWindowArea_px; ++i) {
    const float* right = right_.ptr<float>(v + i / kWindow_px - kReach_px) + first + i % kWindow_px - kReach_px;
    for (std::size_t k = 0; k < scratch.size(); ++k) scratch[k] += window[i] * right[k];
  }
  const float* contrasts = contrast_.ptr<float>(v) + first;
  float best = -1.0f;
  for (std::size_t k = 0; k < scratch.size(); ++k) best = std::max(best, scratch[k] / contrasts[k]);
  return best / (kWindowArea_px * std::max(contrast, kLeastContrast));
}

/// A window of the left image less its mean.  @return its standard deviation.
float WindowMatcher::centredWindow(int u, int v, float* window) const {
  float sum = 0.0f, squares = 0.0f;
  for (int i = 0; i < kWindowArea_px; ++i) {
    window[i] = left_.at<std::uint8_t>(v + i / kWindow_px - kReach_px, u + i % kWindow_px - kReach_px);
    sum += window[i];
  }
  for (int i = 0; i < kWindowArea_px; ++i) {
    window[i] -= sum / kWindowArea_px;
    squares += window[i] * window[i];
  }
  return std::sqrt(squares / kWindowArea_px);
}

}  // namespace flight_corridor
