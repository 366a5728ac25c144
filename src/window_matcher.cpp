#include "flight_corridor/window_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

namespace {

constexpr int kLargestWindow_px = 2 * WindowMatcher::kLargestReach_px + 1;
constexpr float kLeastContrast = 1.0f;  // [grey] of a window, to be divided by

}  // namespace

WindowMatcher::WindowMatcher(const cv::Mat& left, const cv::Mat& right, cv::Range rows, int reach_px)
    : reach_px_(reach_px), first_row_(std::max(rows.start - reach_px, 0)) {
  CV_Assert(0 <= reach_px && reach_px <= kLargestReach_px);
  rows = {first_row_, std::min(rows.end + reach_px, left.rows)};
  left_ = left.rowRange(rows);
  right.rowRange(rows).convertTo(right_, CV_32F);
  const cv::Size window(2 * reach_px + 1, 2 * reach_px + 1);
  cv::Mat mean, mean_of_squares;
  cv::boxFilter(right_, mean, CV_32F, window);
  cv::sqrBoxFilter(right_, mean_of_squares, CV_32F, window);
  cv::sqrt(cv::max(mean_of_squares - mean.mul(mean), kLeastContrast * kLeastContrast), contrast_);
}

int WindowMatcher::correlations(int u, int v, int first_px, int last_px, std::vector<float>& out) const {
  v -= first_row_;
  out.clear();
  if (v < reach_px_ || v + reach_px_ >= left_.rows || u < reach_px_ || u + reach_px_ >= left_.cols) return last_px;
  const int first = std::max(u - last_px, reach_px_), last = std::min(u - first_px, right_.cols - 1 - reach_px_);
  if (last < first) return last_px;
  const int window_px = 2 * reach_px_ + 1;
  float window[kLargestWindow_px * kLargestWindow_px];
  const float contrast = centredWindow(u, v, window);
  out.assign(last - first + 1, 0.0f);  // covariances
  for (int row = 0; row < window_px; ++row) {
    for (int column = 0; column < window_px; ++column) {
      const float grey = window[row * window_px + column];
      const float* right = right_.ptr<float>(v + row - reach_px_) + first + column - reach_px_;
      for (std::size_t k = 0; k < out.size(); ++k) out[k] += grey * right[k];
    }
  }
  const float* contrasts = contrast_.ptr<float>(v) + first;
  const float scale = 1.0f / (static_cast<float>(window_px * window_px) * std::max(contrast, kLeastContrast));
  for (std::size_t k = 0; k < out.size(); ++k) out[k] *= scale / contrasts[k];
  return u - first;
}

float WindowMatcher::correlation(int u, int v, int first_px, int last_px, std::vector<float>& scratch) const {
  correlations(u, v, first_px, last_px, scratch);
  return scratch.empty() ? -1.0f : *std::max_element(scratch.begin(), scratch.end());
}

/// A window of the left image less its mean.  @return its standard deviation.
float WindowMatcher::centredWindow(int u, int v, float* window) const {
  const int window_px = 2 * reach_px_ + 1, area_px = window_px * window_px;
  float sum = 0.0f, squares = 0.0f;
  for (int i = 0; i < area_px; ++i) {
    window[i] = left_.at<std::uint8_t>(v + i / window_px - reach_px_, u + i % window_px - reach_px_);
    sum += window[i];
  }
  for (int i = 0; i < area_px; ++i) {
    window[i] -= sum / static_cast<float>(area_px);
    squares += window[i] * window[i];
  }
  return std::sqrt(squares / static_cast<float>(area_px));
}

}  // namespace flight_corridor
