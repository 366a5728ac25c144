#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/box.hpp"
#include "flight_corridor/disparity_estimator.hpp"
#include "flight_corridor/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

class WindowMatcher;

/// What the texture without a match says of a box, where nothing known hides it from the right camera.
///
/// What fits on the surfaces around it, and these lie behind the box, is theirs, and fills their depth images where it
/// fits no better in the box: equal pickets and ropes have several good matches, of which none is unique. On the
/// surface that the LiDAR's beam meets it may fit a little less well.
///
/// What would fit in the box, but not on the surfaces around, is what a thing leaves behind whose matches are wrong or
/// missing. Of two parallel wires each fits on the other; they are found far away, and betrayed by what is left over of
/// them and by the background that they hide from one camera. Nets and fences do the same. So is a match of a thing
/// smaller than stereo/speckle_window_px: it blocks where it fills a cell, and is in doubt where it does not.
class UnmatchedTexture {
 public:
  /// @param disparity of the pair.  @param matched_m CV_32FC1, depth of its matches [m], NaN = none.
  /// @param nearest_m nothing nearer was searched for [m].  @param box_C the box in C.
  /// @param told_m depth of what the LiDAR's beam meets in the view of the box's end; NaN when nothing is told.
  UnmatchedTexture(const StereoGeometry& geometry, const StereoFrame& pair, const Disparity& disparity,
                   const cv::Mat& matched_m, double nearest_m, const Box& box_C, double told_m = kNaN);

  /// Share of the texture that would fit in the box alone [0..1]: the largest of the views of its cross-sections.
  double share() const { return share_; }

  /// That texture, in the rectangle around those views; elsewhere 0.  @return CV_32FC1 [grey], the images' size.
  cv::Mat image() const;

  /// Gives pixels without a depth that of the surface behind the box that they fit on, and tells the background.
  /// @param depth of geometry.size(); its background is written.
  void fill(DepthImages& depth) const;

 private:
  class Search;

  void judge(int u, int v, const Disparity& disparity, Search& search);

  cv::Size size_;
  cv::Rect area_;       // around the views
  cv::Mat unmatched_;   // CV_32FC1 [grey], of the area
  cv::Mat background_;  // CV_8UC1, of the area
  cv::Mat behind_m_;    // CV_32FC1 [m], of the area, NaN = nothing
  double share_ = 0.0;
};

}  // namespace flight_corridor
