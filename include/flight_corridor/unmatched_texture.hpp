#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/box.hpp"
#include "flight_corridor/disparity_estimator.hpp"
#include "flight_corridor/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Texture that was not matched although nothing known hides it from the right camera, and that would fit no farther
/// than a box's end, but not on the surfaces around it: what a thing leaves behind whose matches are wrong or missing.
/// Of two parallel wires each fits on the other; they are found far away, and betrayed by what is left over of them and
/// by the background that they hide from one camera. Nets and fences do the same. So is a match of a thing smaller than
/// stereo/speckle_window_px: it blocks where it fills a cell, and is in doubt where it does not. A view of its
/// arguments: they must live longer.
class UnmatchedTexture {
 public:
  /// @param disparity of the pair.  @param matched_m CV_32FC1, depth of its matches [m], NaN = none.
  /// @param nearest_m nothing nearer was searched for [m].
  UnmatchedTexture(const StereoGeometry& geometry, const StereoFrame& pair, const Disparity& disparity,
                   const cv::Mat& matched_m, double nearest_m);

  /// Its share of the texture [0..1]: the largest of the views of a box's cross-sections.
  /// @param box_C the box in C.
  double share(const Box& box_C) const;

  /// It alone, in the rectangle around those views; elsewhere 0.  @return CV_32FC1 [grey], the images' size.
  cv::Mat image(const Box& box_C) const;

 private:
  cv::Mat unmatched(const cv::Rect& area, double farthest_m) const;
  int matcherDisparity(double disparity_px) const;
  std::array<float, 4> depthsAround(int u, int v) const;
  template <class Work>
  void forEachGap(int v, const Work& work) const;
  bool isHidden(const float* depth_m, int first, int end) const;

  const StereoGeometry& geometry_;
  const StereoFrame& pair_;
  const Disparity& disparity_;
  cv::Mat matched_m_;  // small things left out
  double nearest_m_;
};

}  // namespace flight_corridor
