#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/corridor.hpp"
#include "flight_corridor/disparity_estimator.hpp"
#include "flight_corridor/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Texture that was not matched although nothing known hides it from the right camera, and that would fit somewhere
/// in a box: what a thing leaves behind whose matches are wrong or missing. Of two parallel wires each fits on the
/// other; they are found far away, and betrayed by what is left over of them and by the background that they hide from
/// one camera. Nets and fences do the same. A view of its arguments: they must live longer.
class UnmatchedTexture {
 public:
  /// @param disparity of the pair, and depth_m, CV_32FC1, NaN = nothing, made of it.
  /// @param nearest_m nothing nearer was searched for.
  UnmatchedTexture(const StereoGeometry& geometry, const StereoFrame& pair, const Disparity& disparity,
                   const cv::Mat& depth_m, double nearest_m);

  /// Share of the texture [0..1]: the largest of a box's cross-sections, as the left image shows them.
  /// @param box_C the box in C.
  double share(const Box& box_C) const;

 private:
  class Matcher;

  std::vector<cv::Rect> sections(const Box& box_C) const;
  cv::Rect view(const Box& box_C, double x_m) const;
  cv::Mat unmatched(const cv::Rect& area, const Matcher& fits) const;
  bool isHidden(int width_px, float before_m, float after_m) const;

  const StereoGeometry& geometry_;
  const StereoFrame& pair_;
  const Disparity& disparity_;
  const cv::Mat& depth_m_;
  double nearest_m_;
};

}  // namespace flight_corridor
