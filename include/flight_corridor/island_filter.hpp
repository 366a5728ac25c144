#pragma once

#include <map>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace flight_corridor {

class WindowMatcher;

/// Tells small things from small mistakes. Where a pattern repeats itself, a few of its matches may lie at another of
/// its periods: an island before the surface that holds the rest. A small thing before a wall is an island, too. But
/// the mistake fits on the surface around it as well, and the thing does not.
class IslandFilter {
 public:
  /// Removes the islands of matches that fit on a surface around them.
  /// @param left, right   CV_8UC1, rectified.
  /// @param disparity_px  CV_32FC1, NaN = no match, u_l - u_r in pixels of the images.
  void filter(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px);

 private:
  struct Island {
    int label = 0, area_px = 0;
    cv::Rect box;
  };

  std::vector<Island> findIslands(const cv::Mat& disparity_px);
  int meanDisparity(const Island& island, const cv::Mat& disparity_px) const;
  std::vector<int> surfacesAround(const Island& island, int island_px);
  bool fits(const Island& island, const WindowMatcher& matcher, int surface_px);

  cv::Mat fixed_, speckles_, islands_, labels_, stats_, centroids_;
  std::map<int, int> matches_;  // around an island, by whole disparity
  std::vector<float> scratch_;
};

}  // namespace flight_corridor
