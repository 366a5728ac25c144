#include "flight_corridor/stereo/exposure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <utility>

namespace flight_corridor {

namespace {

constexpr double kLargestGain = 4.0;    // between the cameras; more is no exposure, but a covered lens
constexpr double kFewestPixels = 0.01;  // share of pixels that have a mean
constexpr double kSameSky = 0.5;        // least ratio of what two cameras clip where they see the same

/// How many pixels have each grey.
class Histogram {
 public:
  explicit Histogram(const cv::Mat& image) : pixels_(static_cast<double>(image.total())) {
    for (int v = 0; v < image.rows; ++v) {
      const auto* row = image.ptr<std::uint8_t>(v);
      for (int u = 0; u < image.cols; ++u) ++counts_[row[u]];
    }
  }

  double shareOf(std::uint8_t grey) const { return counts_[grey] / pixels_; }

  /// Mean and standard deviation of the pixels from one rank to another: shares of them all, in the order of their
  /// greys. 0 where there are too few.
  std::pair<double, double> moments(double first, double last) const {
    double below = 0.0, n = 0.0, sum = 0.0, squares = 0.0;
    for (int grey = 0; grey < 256; ++grey) {
      const double above = below + counts_[static_cast<std::size_t>(grey)] / pixels_;
      const double share = std::max(0.0, std::min(above, last) - std::max(below, first));
      n += share;
      sum += share * grey;
      squares += share * grey * grey;
      below = above;
    }
    if (!(n >= kFewestPixels)) return {0.0, 0.0};
    const double mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean))};
  }

 private:
  std::array<int, 256> counts_ = {};
  double pixels_;
};

}  // namespace

void balanceExposure(const cv::Mat& left, const cv::Mat& right, cv::Mat& balanced_right) {
  const Histogram left_greys(left), right_greys(right);
  const double darkest = std::max(left_greys.shareOf(0), right_greys.shareOf(0));
  const double brightest = 1.0 - std::max(left_greys.shareOf(255), right_greys.shareOf(255));
  const auto [left_mean, left_contrast] = left_greys.moments(darkest, brightest);
  const auto [right_mean, right_contrast] = right_greys.moments(darkest, brightest);
  const double ratio = left_contrast / right_contrast;
  const double gain = 1.0 / kLargestGain <= ratio && ratio <= kLargestGain ? ratio : 1.0;  // 1 for NaN
  right.convertTo(balanced_right, CV_8U, gain, left_mean - gain * right_mean);
  if (left_greys.shareOf(255) >= kSameSky * right_greys.shareOf(255)) balanced_right.setTo(255, right == 255);
}

}  // namespace flight_corridor
