#include "flight_corridor/stereo/window_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace flight_corridor {

namespace {

constexpr int kWindow_px = 2 * WindowMatcher::kReach_px + 1, kArea_px = kWindow_px * kWindow_px;
constexpr double kShare = 1.0 / kArea_px;  // of a pixel
constexpr float kLeastContrast = 1.0f;     // [grey] of a window, to be divided by

}  // namespace

WindowMatcher::WindowMatcher(const cv::Mat& left, const cv::Mat& right, cv::Range rows)
    : first_row_(std::max(rows.start - kReach_px, 0)),
      left_(left.rowRange(first_row_, std::min(rows.end + kReach_px, left.rows))),
      contrast_(left_.total(), kLeastContrast) {
  right_.reserve(left_.total());
  for (int v = 0; v < left_.rows; ++v) {
    const auto* row = right.ptr<std::uint8_t>(first_row_ + v);
    right_.insert(right_.end(), row, row + left_.cols);
  }
  findContrasts();
}

/// Standard deviation of each window of the right image; of greys the sums are exact.
void WindowMatcher::findContrasts() {
  const int last = left_.cols - 1 - kReach_px;
  std::vector<float> sums, squares;
  for (int v = kReach_px; v + kReach_px < left_.rows; ++v) {
    sums.assign(left_.cols, 0.0f);
    squares.assign(left_.cols, 0.0f);
    for (int i = 0; i < kArea_px; ++i) {
      const float* greys = right(v + i / kWindow_px - kReach_px) + i % kWindow_px - kReach_px;
      for (int u = kReach_px; u <= last; ++u) {
        sums[u] += greys[u];
        squares[u] += greys[u] * greys[u];
      }
    }
    float* contrasts = &contrast_[static_cast<std::size_t>(v) * left_.cols];
    for (int u = kReach_px; u <= last; ++u) {
      const auto mean = static_cast<float>(sums[u] * kShare), mean_of_squares = static_cast<float>(squares[u] * kShare);
      contrasts[u] = std::sqrt(std::max(mean_of_squares - mean * mean, kLeastContrast * kLeastContrast));
    }
  }
}

int WindowMatcher::correlations(int u, int v, int first_px, int last_px, std::vector<float>& out) const {
  v -= first_row_;
  out.clear();
  if (v < kReach_px || v + kReach_px >= left_.rows || u < kReach_px || u + kReach_px >= left_.cols) return last_px;
  const int first = std::max(u - last_px, kReach_px), last = std::min(u - first_px, left_.cols - 1 - kReach_px);
  if (last < first) return last_px;
  float window[kArea_px];
  const float contrast = centredWindow(u, v, window);
  out.assign(last - first + 1, 0.0f);  // covariances
  for (int row = 0; row < kWindow_px; ++row) {
    for (int column = 0; column < kWindow_px; ++column) {
      const float grey = window[row * kWindow_px + column];
      const float* greys = right(v + row - kReach_px) + first + column - kReach_px;
      for (std::size_t k = 0; k < out.size(); ++k) out[k] += grey * greys[k];
    }
  }
  const float* contrasts = &contrast_[static_cast<std::size_t>(v) * left_.cols + first];
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
