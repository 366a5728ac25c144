#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace flight_corridor {

/// How well a small window of the left image fits on one of the right image's, within a range of disparities, by
/// normalised cross-correlation: whatever the exposures. A view of the left image; many threads may ask it.
class WindowMatcher {
 public:
  static constexpr int kReach_px = 2, kLargestReach_px = 7;  ///< Of a window, from its centre.
  static constexpr float kFits = 0.85f;                      ///< Least correlation of windows that fit.
  /// @param left, right CV_8UC1, rectified.  @param rows that are asked about.
  /// @param reach_px of a window, from its centre, at most kLargestReach_px.
  WindowMatcher(const cv::Mat& left, const cv::Mat& right, cv::Range rows, int reach_px = kReach_px);

  /// Normalised cross-correlation by disparity.
  /// @param first_px, last_px disparities, principal-point difference included.
  /// @param out refilled, from the largest disparity downwards; those whose window is not whole on both images are left
  /// out.
  /// @return the largest disparity in out.
  int correlations(int u, int v, int first_px, int last_px, std::vector<float>& out) const;

  /// @param scratch of the calling thread.
  /// @return the best of correlations(); -1 where there is none.
  float correlation(int u, int v, int first_px, int last_px, std::vector<float>& scratch) const;

  bool fits(int u, int v, int first_px, int last_px, std::vector<float>& scratch) const {
    return correlation(u, v, first_px, last_px, scratch) >= kFits;
  }

 private:
  float centredWindow(int u, int v, float* window) const;

  int reach_px_, first_row_;
  cv::Mat left_, right_, contrast_;
};

}  // namespace flight_corridor
