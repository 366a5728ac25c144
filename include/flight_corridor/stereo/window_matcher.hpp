#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace flight_corridor {

/// Correlation of a small window of the left image with those of the right image, within a range of disparities. It is
/// normalised, so exposures may differ. A view of the left image.
class WindowMatcher {
 public:
  static constexpr int kReach_px = 2;  ///< Of a window, from its centre.

  /// @param left, right CV_8UC1, rectified.  @param rows that may be requested.
  WindowMatcher(const cv::Mat& left, const cv::Mat& right, cv::Range rows);

  /// Normalised cross-correlation by disparity.
  /// @param first_px, last_px disparities, principal-point difference included.
  /// @param out refilled, from the largest disparity downwards, without those whose window is not wholly on both
  /// images.
  /// @return the largest disparity in out.
  int correlations(int u, int v, int first_px, int last_px, std::vector<float>& out) const;

 private:
  void findContrasts();
  float centredWindow(int u, int v, float* window) const;
  const float* right(int v) const { return &right_[static_cast<std::size_t>(v) * left_.cols]; }

  int first_row_;
  cv::Mat left_;
  std::vector<float> right_, contrast_;  // the same rows
};

}  // namespace flight_corridor
