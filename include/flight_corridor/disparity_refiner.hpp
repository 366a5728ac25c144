#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace flight_corridor {

/// Takes the pull towards whole pixels, and most of the noise, out of a matcher's disparity.
///
/// A matcher fits a parabola to costs at whole pixels, which biases its sub-pixel part by up to 0.2 px (Shimizu and
/// Okutomi 2001). Steps of image registration (Lucas and Kanade 1981) from where it ended measure the rest; after each
/// a mean over neighbours on the same surface removes noise without smearing edges.
class DisparityRefiner {
 public:
  /// @param left, right rectified, CV_8UC1, same size.
  /// @param disparity_px CV_32FC1 of that size, u_left - u_right, NaN = none; refined in place. What was NaN stays NaN.
  /// @param thin CV_8U of that size, refilled: 255 on things so thin that most disparities around their pixels are of
  /// other surfaces. Those draw them to themselves: they are less exact.
  void refine(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px, cv::Mat& thin);

 private:
  struct Band {  // scratch for a run of rows, which one thread works on
    std::vector<float> products, rows, sums;
  };
  void registerRows(const cv::Mat& left, const cv::Mat& right, const cv::Mat& disparity_px, cv::Range rows, Band& band);
  static void averageRows(const cv::Mat& surfaces_px, const cv::Mat& values, cv::Point step, cv::Range rows,
                          cv::Mat& mean, cv::Mat& own_share, Band& band);

  std::array<Band, 8> bands_;
  cv::Mat registered_, smoothed_;
  cv::Mat row_share_, column_share_, share_;  // of the neighbours along each and both: those on the same surface
};

}  // namespace flight_corridor
