#include "flight_corridor/stereo/texture.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace flight_corridor {

namespace {

constexpr int kAcross_px = 4, kAlong_px = 2;  // reach of the window, 9 x 5: the census's, and two rows more
constexpr int kApart_px = 2;                  // distance of the compared pixels to either side: blur is no wider
constexpr int kWindow = (2 * kAcross_px + 1) * (2 * kAlong_px + 1);
constexpr double kAboveNoise = 2.0;  // of the variance of noise alone, which is off by a fifth over such a window
constexpr int kBlock_px = 16;        // squares in which the noise is measured
constexpr double kSmoothest = 0.2;   // share of the blocks: those show noise alone
constexpr double kLeastNoise_grey = 0.7, kMostNoise_grey = 6.0;  // rounding; a scene that is texture all over
constexpr int kDark = 2, kBright = 250;                          // beyond these, noise is clipped

bool isClipped(int grey) { return grey <= kDark || grey >= kBright; }

/// RMS of second differences along the rows of a block, of which noise has six times its variance (after Immerkaer
/// 1996); NaN if the block is clipped.
float spreadOf(const cv::Mat& grey, int u0, int v0) {
  int squares = 0, clipped = 0;
  for (int v = v0; v < v0 + kBlock_px; ++v) {
    const std::uint8_t* row = grey.ptr(v);
    for (int u = u0; u < u0 + kBlock_px; ++u) {
      const auto second = static_cast<std::int16_t>(row[u - 1] - 2 * row[u] + row[u + 1]);
      squares += second * second;
      clipped += isClipped(row[u]);
    }
  }
  constexpr int kPixels = kBlock_px * kBlock_px;
  return 10 * clipped < kPixels ? std::sqrt(static_cast<float>(squares) / (6.0f * kPixels)) : NAN;
}

double noiseOf(const cv::Mat& grey, std::vector<float>& spreads) {
  spreads.clear();
  for (int v = 0; v + kBlock_px <= grey.rows; v += kBlock_px) {
    for (int u = 1; u + kBlock_px < grey.cols; u += kBlock_px) {
      if (const float spread = spreadOf(grey, u, v); !std::isnan(spread)) spreads.push_back(spread);
    }
  }
  if (spreads.empty()) return kMostNoise_grey;
  const auto smooth = spreads.begin() + static_cast<std::ptrdiff_t>(kSmoothest * spreads.size());
  std::nth_element(spreads.begin(), smooth, spreads.end());
  return std::clamp<double>(*smooth, kLeastNoise_grey, kMostNoise_grey);
}

}  // namespace

const cv::Mat& Texture::find(const cv::Mat& grey, const cv::Mat& covered) {
  noise_ = noiseOf(grey, spreads_);
  textured_.create(grey.size(), CV_8UC1);
  clipped_.create(grey.size(), CV_8UC1);
  const int enough = static_cast<int>(kAboveNoise * 2.0 * noise_ * noise_ * kWindow * kWindow);
  const auto rowAt = [&](int v) { return grey.ptr(std::clamp(v, 0, grey.rows - 1)); };
  sum_.assign(grey.cols, 0);
  squares_.assign(grey.cols, 0);
  const auto add = [&](int v, int sign) {
    const std::uint8_t *left = rowAt(v), *right = left + 2 * kApart_px;
    int *sum = sum_.data() + kApart_px, *squares = squares_.data() + kApart_px;
    for (int i = 0, size = grey.cols - 2 * kApart_px; i < size; ++i) {
      const auto difference = static_cast<std::int16_t>(right[i] - left[i]);
      sum[i] += sign * difference;
      squares[i] += sign * static_cast<std::uint16_t>(difference * difference);  // of 16 bits: faster in vectors
    }
  };
  for (int v = -kAlong_px; v < kAlong_px; ++v) add(v, 1);
  for (int v = 0; v < grey.rows; ++v) {
    add(v + kAlong_px, 1);
    findRow(grey, v, enough);
    add(v - kAlong_px, -1);
  }
  if (!covered.empty()) {
    textured_.setTo(255, covered);
    clipped_.setTo(0, covered);
  }
  return textured_;
}

/// Columns beyond the image hold no difference: near its sides there is less texture.
void Texture::findRow(const cv::Mat& grey, int v, int enough) {
  const std::uint8_t* row = grey.ptr(v);
  std::uint8_t *textured = textured_.ptr(v), *clipped = clipped_.ptr(v);
  int sum = 0, squares = 0;
  for (int u = 0; u < std::min(kAcross_px, grey.cols); ++u) sum += sum_[u], squares += squares_[u];
  for (int u = 0; u < grey.cols; ++u) {
    if (u + kAcross_px < grey.cols) sum += sum_[u + kAcross_px], squares += squares_[u + kAcross_px];
    textured[u] = kWindow * squares - sum * sum > enough ? 255 : 0;
    clipped[u] = textured[u] == 0 && isClipped(row[u]) ? 255 : 0;
    if (u >= kAcross_px) sum -= sum_[u - kAcross_px], squares -= squares_[u - kAcross_px];
  }
}

}  // namespace flight_corridor
