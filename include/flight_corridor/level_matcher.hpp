#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace flight_corridor {

/// Finds thin level things (branches, wires) that a matcher with square blocks and smoothing gives to their background.
/// Along a level edge grey values hardly vary, so only a long window along the edge tells one disparity from another;
/// it compares vertical gradients, which do not depend on the exposures' difference.
class LevelMatcher {
 public:
  /// @param min_disparity_px, num_disparities_px  the range that is searched, as the matcher's own.
  LevelMatcher(int min_disparity_px, int num_disparities_px);

  /// Sets the disparity of level edges that are clearly nearer than what was matched there.
  /// @param left, right   CV_8UC1, rectified.
  /// @param disparity_px  CV_32FC1, NaN = no match, u_l - u_r in pixels of the images.
  /// @param level  refilled: CV_8U, 255 where it was set.
  void match(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px, cv::Mat& level);

 private:
  struct Window {
    int reach_px;          // along the edge, from its middle
    int stride_px;         // of the columns that it is laid around
    double smallest_step;  // mean vertical step [grey/px] that is an edge
  };
  /// The longer one tells what is nearly as grey as its background, the shorter one what is short or bends.
  static constexpr Window kWindows[] = {{15, 1, 10.0}, {45, 3, 5.0}};

  void find(const Window& window, const cv::Mat& disparity_px);
  float disparityAt(int u, int v, int reach_px, float matched_px);
  double slopeAt(int u, int v, int reach_px) const;
  float best(int first_px, float matched_px, int edge) const;

  int min_disparity_px_, num_disparities_px_;
  cv::Mat left_steps_, right_steps_, across_, along_, vertical_, horizontal_;
  cv::Mat found_px_, nearest_px_;
  std::vector<std::uint16_t> costs_;  // of one pixel, by disparity
  std::vector<float> row_px_;         // found by one window in one row
};

}  // namespace flight_corridor
