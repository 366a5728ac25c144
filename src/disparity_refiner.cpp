#include "flight_corridor/disparity_refiner.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

namespace {

constexpr int kWindow_px = 7;            // edge of the window that is registered
constexpr float kLargestStep_px = 0.3f;  // the bias is less; a longer step follows noise or another surface
constexpr float kNoise = 0.5f;           // squared gradient [grey^2/px^2] that noise alone shows
constexpr int kReach_px = 7;             // how far a surface is averaged, along rows and columns
constexpr float kSameSurface_px = 1.0f;  // neighbours that differ by less

/// Per pixel: 1, residual e, gradient g, e g, g^2; all 0 where there is no disparity.
using Products = cv::Vec<float, 5>;

}  // namespace

void DisparityRefiner::refine(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px) {
  registerImages(left, right, disparity_px);
  smooth(disparity_px, smoothed_, {1, 0});
  smooth(smoothed_, disparity_px, {0, 1});
}

/// R(u - d - step) = L(u) to first order, in the least-squares sense over a window, whatever the exposures' difference.
void DisparityRefiner::registerImages(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px) {
  // Four taps, not two: a gradient that is too small makes the step too long.
  static const cv::Mat kDerivative = (cv::Mat_<float>(1, 5) << 1, -8, 0, 8, -1) / 12.0;
  cv::filter2D(left, gradient_, CV_32F, kDerivative);
  products_.create(left.size(), CV_32FC(5));
  for (int v = 0; v < left.rows; ++v) {
    const auto* L = left.ptr<std::uint8_t>(v);
    const auto* R = right.ptr<std::uint8_t>(v);
    const auto* g = gradient_.ptr<float>(v);
    const auto* d = disparity_px.ptr<float>(v);
    auto* out = products_.ptr<Products>(v);
    for (int u = 0; u < left.cols; ++u) {
      const float x = static_cast<float>(u) - d[u];
      if (!(0.0f <= x && x < static_cast<float>(left.cols - 1))) {
        out[u] = Products::all(0.0f);
        continue;
      }
      const int i = static_cast<int>(x);
      const float there = R[i] + (x - static_cast<float>(i)) * static_cast<float>(R[i + 1] - R[i]);
      const float e = there - L[u];
      out[u] = Products(1.0f, e, g[u], e * g[u], g[u] * g[u]);
    }
  }
  cv::boxFilter(products_, sums_, -1, {kWindow_px, kWindow_px}, {-1, -1}, false, cv::BORDER_CONSTANT);
  for (int v = 0; v < left.rows; ++v) {
    const auto* sum = sums_.ptr<Products>(v);
    auto* d = disparity_px.ptr<float>(v);
    for (int u = 0; u < left.cols; ++u) {
      const float n = std::max(sum[u][0], 1.0f);
      const float covariance = sum[u][3] - sum[u][1] * sum[u][2] / n;
      const float variance = sum[u][4] - sum[u][2] * sum[u][2] / n;
      d[u] += std::clamp(covariance / (variance + n * kNoise), -kLargestStep_px, kLargestStep_px);
    }
  }
}

/// The mean of the neighbours along one direction that lie on the same surface.
void DisparityRefiner::smooth(const cv::Mat& in, cv::Mat& out, cv::Point step) {
  out.create(in.size(), CV_32FC1);
  sum_px_.resize(static_cast<std::size_t>(in.cols));
  count_.resize(static_cast<std::size_t>(in.cols));
  float* sum_px = sum_px_.data();
  float* count = count_.data();
  for (int v = 0; v < in.rows; ++v) {
    const auto* centre = in.ptr<float>(v);
    std::fill_n(sum_px, in.cols, 0.0f);
    std::fill_n(count, in.cols, 0.0f);
    for (int k = -kReach_px; k <= kReach_px; ++k) {
      if (v + k * step.y < 0 || v + k * step.y >= in.rows) continue;
      const auto* row = in.ptr<float>(v + k * step.y);
      const int shift = k * step.x;
      for (int u = std::max(0, -shift); u < std::min(in.cols, in.cols - shift); ++u) {
        const float difference_px = row[u + shift] - centre[u];
        const bool same = std::abs(difference_px) < kSameSurface_px;  // NaN is not
        sum_px[u] += same ? difference_px : 0.0f;
        count[u] += same ? 1.0f : 0.0f;
      }
    }
    auto* mean = out.ptr<float>(v);
    for (int u = 0; u < in.cols; ++u) mean[u] = centre[u] + sum_px[u] / count[u];  // 0 / 0 only where centre is NaN
  }
}

}  // namespace flight_corridor
