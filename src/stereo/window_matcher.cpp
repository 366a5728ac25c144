#include "flight_corridor/stereo/window_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

namespace {

constexpr int kWindow_px = 2 * WindowMatcher::kReach_px + 1, kArea_px = kWindow_px * kWindow_px;
constexpr float kLeastContrast = 1.0f;  // [grey] of a window, to be divided by

}  // namespace

WindowMatcher::WindowMatcher(const cv::Mat& left, const cv::Mat& right, cv::Range rows)
    : first_row_(std::max(rows.start - kReach_px, 0)) {
  rows = {first_row_, std::min(rows.end + kReach_px, left.rows)};
  left_ = left.rowRange(rows);
  right.rowRange(rows).convertTo(right_, CV_32F);
  const cv::Size window(kWindow_px, kWindow_px);
  cv::Mat mean, mean_of_squares;
  cv::boxFilter(right_, mean, CV_32F, window);
  cv::sqrBoxFilter(right_, mean_of_squares, CV_32F, window);
  cv::sqrt(cv::max(mean_of_squares - mean.mul(mean), kLeastContrast * kLeastContrast), contrast_);
}

int WindowMatcher::correlations(int u, int v, int first_px, int last_px, std::vector<float>& out) const {
  v -= first_row_;
  out.clear();
  if (v < kReach_px || v + kReach_px >= left_.rows || u < kReach_px || u + kReach_px >= left_.cols) return last_px;
  const int first = std::max(u - last_px, kReach_px), last = std::min(u - first_px, right_.cols - 1 - kReach_px);
  if (last < first) return last_px;
  float window[kArea_px];
  const float contrast = centredWindow(u, v, window);
  out.assign(last - first + 1, 0.0f);  // covariances
  for (int row = 0; row < kWindow_px; ++row) {
    for (int column = 0; column < kWindow_px; ++column) {
      const float grey = window[row * kWindow_px + column];
      const float* right = right_.ptr<float>(v + row - kReach_px) + first + column - kReach_px;
      for (std::size_t k = 0; k < out.size(); ++k) out[k] += grey * right[k];
    }
  }
  const float* contrasts = contrast_.ptr<float>(v) + first;
  const float scale = 1.0f / (static_cast<float>(kArea_px) * std::max(contrast, kLeastContrast));
  for (std::size_t k = 0; k < out.size(); ++k) out[k] *= scale / contrasts[k];
  return u - first;
}

/// A window of the left image less its mean.  @return its standard deviation.
float WindowMatcher::centredWindow(int u, int v, float* window) const {
  float sum = 0.0f, squares = 0.0f;
  for (int i = 0; i < kArea_px; ++i) {
    window[i] = left_.at<std::uint8_t>(v + i / kWindow_px - kReach_px, u + i % kWindow_px - kReach_px);
    sum += window[i];
  }
  for (int i = 0; i < kArea_px; ++i) {
    window[i] -= sum / static_cast<float>(kArea_px);
    squares += window[i] * window[i];
  }
  return std::sqrt(squares / static_cast<float>(kArea_px));
}

}  // namespace flight_corridor
