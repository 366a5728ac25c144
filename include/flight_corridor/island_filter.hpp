#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace flight_corridor {

class WindowMatcher;

/// Tells small things from small mistakes among a matcher's islands: neighbours of nearly the same disparity, fewer
/// than 400 px. Where a pattern repeats itself, some of its matches may lie at another of its periods, before the
/// surface that holds the rest. A small thing before a wall is an island, too. But a thing fits where it was matched
/// on many more of its pixels than on any surface around it.
class IslandFilter {
 public:
  /// @param speckle_px smaller islands are removed unless they are a thing that is nearer than all that is around.
  /// 0: nothing is removed at all.
  /// @param step_px between neighbours of one island.
  IslandFilter(int speckle_px, int step_px);

  /// Removes speckles, and the larger islands that fit on a surface around them.
  /// @param left, right CV_8UC1, rectified.
  /// @param fixed       CV_16S, u_l - u_r in sixteenths of a pixel.
  /// @param none        what stands in it for no match.
  /// @param small       refilled: CV_8U, 255 where a thing as small as a speckle stayed.
  void filter(const cv::Mat& left, const cv::Mat& right, cv::Mat& fixed, std::int16_t none, cv::Mat& small);

 private:
  enum class Side { Left, Right };

  void takeIsland(const cv::Mat& fixed, const cv::Point& start);
  bool isSpeckle() const { return static_cast<int>(island_.size()) <= speckle_px_; }
  bool isThing(const WindowMatcher& matcher, const cv::Mat& fixed);
  void findSurfaces();
  double ownShare(const WindowMatcher& matcher, const cv::Mat& fixed);
  double shareOn(int surface_px, Side side, const WindowMatcher& matcher, const cv::Mat& fixed);

  int speckle_px_, step_;
  cv::Mat surfaces_;  // without the islands
  cv::Mat islands_;   // those that were not looked at yet
  cv::Mat claimed_;   // of an image, by the island that is looked at
  cv::Mat speckles_;  // scratch of OpenCV
  std::vector<cv::Point> island_;
  int island_px_ = 0;                       // its mean disparity
  std::vector<int> matches_, surfaces_px_;  // around it: by whole disparity; disparities of surfaces
  std::vector<float> scratch_;
};

}  // namespace flight_corridor
